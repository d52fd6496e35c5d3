//! The gas in the bubbles: what volume each shall have, what pressure holds it there, and what becomes of both when bubbles divide,
//! burst or vanish.

use std::collections::BTreeMap;

use bevy_ecs::resource::Resource;
use bevy_ecs::world::World;
use froth_components::gas::{GasPressure, GasVolume, ReferencePressure, ReferenceVolume};
use froth_components::identity::{InRegion, RegionId};
use froth_components::kind::{Kind, Region as RegionKind};
use froth_components::material::Atmosphere;
use froth_surface::bodies::Division;
use froth_surface::{Region, Surface};
use serde::{Deserialize, Serialize};

use crate::rows::fill_column;
use crate::rows::registry::ColumnRegistry;
use crate::tracker::films;
use crate::tracker::remeshing::{GasChange, GasChanges};
use crate::tracker::tension::BubbleTensions;

/// What a bubble's volume goes to, evenly.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ramp {
    /// Volume in the end, m^3.
    pub volume: f64,
    /// When it is reached, s.
    pub end: f64,
}

impl Ramp {
    /// Volume at a time `to` of a bubble that has `volume` at `from`: on the straight line from there to the end.
    fn at(&self, volume: f64, from: f64, to: f64) -> f64 {
        if to >= self.end { self.volume } else { volume + (self.volume - volume) * (to - from) / (self.end - from) }
    }
}

/// Gas of the closed regions. State of a run.
#[derive(Resource, Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BubbleGas {
    /// Volume that each closed region shall have, m^3.
    pub targets: BTreeMap<Region, f64>,
    /// Pressure of each above the outside, Pa.
    pub pressures: BTreeMap<Region, f64>,
    /// What volumes go to, where the scene has them change.
    pub ramps: BTreeMap<Region, Ramp>,
}

impl BubbleGas {
    /// Every closed region keeps the volume that it has.
    #[must_use]
    pub fn of(surface: &Surface) -> Self {
        let volumes = surface.volumes();
        let closed = surface.mesh.regions().into_iter().filter(|region| !surface.is_open(*region));
        let targets: BTreeMap<Region, f64> = closed.map(|region| (region, volumes[region.index()])).collect();
        let pressures = targets.keys().map(|region| (*region, 0.0)).collect();
        Self { targets, pressures, ramps: BTreeMap::new() }
    }

    /// Lets volumes go to what they shall be at a time `to`; they are as they shall be at `from`. Seconds.
    pub fn fill(&mut self, from: f64, to: f64) {
        for (region, ramp) in &self.ramps {
            if let Some(target) = self.targets.get_mut(region) {
                *target = ramp.at(*target, from, to);
            }
        }
        self.ramps.retain(|_, ramp| ramp.end > to);
    }

    /// Mean rates at which gas comes into the bubbles whose volumes change between two times, as [`Self::fill`] lets it, m^3/s.
    #[must_use]
    pub fn inflows(&self, from: f64, to: f64) -> BTreeMap<Region, f64> {
        let inflow = |(region, ramp): (&Region, &Ramp)| {
            let volume = *self.targets.get(region)?;
            Some((*region, (ramp.at(volume, from, to) - volume) / (to - from)))
        };
        self.ramps.iter().filter_map(inflow).collect()
    }

    /// Follows regions that were joined, divided, or are gone.
    pub fn follow(&mut self, changes: &GasChanges, surface: &Surface) {
        for change in &changes.0 {
            match change {
                GasChange::Joined(gone, into) => self.join(*gone, *into),
                GasChange::Divided(division) => self.divide(division),
            }
        }
        let regions = surface.mesh.regions();
        self.targets.retain(|region, _| regions.binary_search(region).is_ok());
        self.pressures.retain(|region, _| regions.binary_search(region).is_ok());
        self.ramps.retain(|region, _| regions.binary_search(region).is_ok());
    }

    fn join(&mut self, gone: Region, into: Region) {
        let volume = self.targets.remove(&gone).unwrap_or(0.0);
        self.pressures.remove(&gone);
        if let Some(target) = self.targets.get_mut(&into) {
            *target += volume;
        }
        self.ramps.remove(&gone);
        if let Some(ramp) = self.ramps.get_mut(&into) {
            ramp.volume += volume;
        }
    }

    /// A closed region shares its gas by volume; a pocket of outside air keeps what it has.
    fn divide(&mut self, division: &Division) {
        let (part, whole) = (division.volume, division.volume + division.rest);
        let old = self.targets.get(&division.from).copied();
        self.targets.insert(division.to, old.map_or(part, |target| target * part / whole));
        if let Some(target) = old {
            self.targets.insert(division.from, target * division.rest / whole);
        }
        if let Some(ramp) = self.ramps.get_mut(&division.from) {
            let all = ramp.volume;
            ramp.volume = all * division.rest / whole;
            let part = Ramp { volume: all * part / whole, ..*ramp };
            self.ramps.insert(division.to, part);
        }
        let pressure = self.pressures.get(&division.from).copied().unwrap_or(0.0);
        self.pressures.insert(division.to, pressure);
    }
}

/// The gas follows what the tracker did in this step.
pub fn follow_bubbles(world: &mut World) {
    let changes = std::mem::take(&mut *world.resource_mut::<GasChanges>());
    world.resource_mut::<BubbleTensions>().follow(&changes);
    let surface = films::take(world);
    let mut gas = std::mem::take(&mut *world.resource_mut::<BubbleGas>());
    gas.follow(&changes, &surface);
    *world.resource_mut::<BubbleGas>() = gas;
    films::put_back(world, surface);
}

/// Writes one row per closed region: its number, volume, target and pressure.
pub fn write_regions(world: &mut World) {
    let surface = films::take(world);
    let volumes = surface.volumes();
    films::put_back(world, surface);
    let gas = world.resource::<BubbleGas>().clone();
    let air = world.resource::<Atmosphere>().pressure;
    let kinds = world.resource::<ColumnRegistry>().kinds();
    let kind = kinds.iter().find(|kind| kind.name == RegionKind::NAME).copied();
    kind.expect("invariant: the flow registers regions").resize(world, gas.targets.len());
    let regions: Vec<Region> = gas.targets.keys().copied().collect();
    let column = |f: &dyn Fn(Region) -> f64| regions.iter().map(|region| f(*region)).collect::<Vec<f64>>();
    let volume = column(&|region| volumes.get(region.index()).copied().unwrap_or(0.0));
    let target = column(&|region| gas.targets[&region]);
    let pressure = column(&|region| air + gas.pressures.get(&region).copied().unwrap_or(0.0));
    let numbers: Vec<InRegion> = regions.iter().map(|region| InRegion(RegionId(region.0))).collect();
    fill_column::<RegionKind, _>(world, &numbers);
    fill_column::<RegionKind, _>(world, &volume.iter().map(|v| GasVolume(*v)).collect::<Vec<_>>());
    fill_column::<RegionKind, _>(world, &target.iter().map(|v| ReferenceVolume(*v)).collect::<Vec<_>>());
    fill_column::<RegionKind, _>(world, &pressure.iter().map(|p| GasPressure(*p)).collect::<Vec<_>>());
    fill_column::<RegionKind, _>(world, &vec![ReferencePressure(air); regions.len()]);
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn gas(volumes: &[f64], end: f64, wanted: f64) -> BubbleGas {
        let regions = || (1..).map(Region).zip(volumes.iter().copied());
        BubbleGas {
            targets: regions().collect(),
            pressures: regions().map(|(region, _)| (region, 0.0)).collect(),
            ramps: regions().map(|(region, _)| (region, Ramp { volume: wanted, end })).collect(),
        }
    }

    #[test]
    fn volumes_go_in_a_straight_line_however_long_the_steps_are() {
        let mut bubbles = gas(&[1.0], 2.0, 5.0);
        let mut from = 0.0;
        for (to, volume) in [(0.5, 2.0), (0.75, 2.5), (1.5, 4.0), (2.5, 5.0)] {
            bubbles.fill(from, to);
            assert!((bubbles.targets[&Region(1)] - volume).abs() < 1e-14, "{to}");
            from = to;
        }
        assert!(bubbles.ramps.is_empty());
    }

    #[test]
    fn gas_comes_in_at_the_rate_at_which_volumes_change() {
        let bubbles = gas(&[1.0, 3.0], 2.0, 5.0);
        let inflows: Vec<f64> = bubbles.inflows(0.0, 0.5).into_values().collect();
        assert!((inflows[0] - 2.0).abs() < 1e-14 && (inflows[1] - 1.0).abs() < 1e-14);
        let at_the_end: Vec<f64> = bubbles.inflows(0.0, 4.0).into_values().collect();
        assert!((at_the_end[0] - 1.0).abs() < 1e-14 && (at_the_end[1] - 0.5).abs() < 1e-14);
    }

    #[test]
    fn gas_goes_with_bubbles_that_join_and_divide() {
        let surface = Surface::from_triangles(&froth_surface::shapes::sphere_lattice([3, 1, 1], 1.0, 1.0, 0.5));
        let mut bubbles = gas(&[1.0, 1.0], 2.0, 3.0);
        let division = Division { from: Region(2), to: Region(3), volume: 1.0, rest: 2.0, place: DVec3::ZERO };
        let changes = GasChanges(vec![GasChange::Divided(division)]);
        bubbles.follow(&changes, &surface);
        bubbles.fill(0.0, 2.0);
        let volumes: Vec<f64> = bubbles.targets.values().copied().collect();
        for (volume, wanted) in volumes.iter().zip([3.0, 2.0, 1.0]) {
            assert!((volume - wanted).abs() < 1e-14, "{volumes:?}");
        }
    }
}
