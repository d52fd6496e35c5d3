//! Burst of a film: the region behind it joins the one in front. Bubbles too small for the mesh end the same way.
//!
//! Every face between the two regions goes, every other face of the region that burst takes the label of the one it joined. Curves
//! where three films met become part of one film; vertices that keep no face vanish.
//! Limits: the whole film goes at once; a hole with a retracting rim is not modelled.

use std::collections::BTreeMap;

use glam::DVec3;
use smallvec::SmallVec;

use super::Session;
use super::plan::Plan;
use crate::event::EventKind;
use crate::mesh::Face;
use crate::rows::{FaceRow, Region};

/// Why a film cannot burst.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BurstRefused {
    /// The two regions share no film.
    #[error("{0} and {1} share no film that could burst")]
    NoFilm(Region, Region),
    /// Open air cannot join a bubble; the bubble joins the open air.
    #[error("open air cannot join {0}; let {0} join it instead")]
    Outside(Region),
}

impl Session<'_> {
    /// Bursts the film between two regions: `gone` joins `into`. Gives the middle of the film that burst.
    ///
    /// # Errors
    /// When the two share no film, or the outside or an open pocket would join a closed bubble.
    pub fn burst(&mut self, gone: Region, into: Region) -> Result<DVec3, BurstRefused> {
        let place = self.join(gone, into)?;
        self.counts.bursts += 1;
        self.note(EventKind::Burst, place, [gone, into]);
        Ok(place)
    }

    /// Lets bubbles that are smaller than any that the mesh can hold ([`Policy::least_volume`](crate::Policy::least_volume)) join the region that
    /// they share most film with; gives who joined whom, `(gone, into)`.
    pub fn dissolve_specks(&mut self) -> Vec<(Region, Region)> {
        let (least, volumes) = (self.policy.least_volume(), self.surface.volumes());
        let regions = self.surface.mesh.regions().into_iter();
        let specks: Vec<Region> =
            regions.filter(|region| !self.surface.is_open(*region) && volumes[region.index()] < least).collect();
        let mut joined = Vec::new();
        for gone in specks {
            // The first of equals; a speck that another has joined may share film with no one any more.
            let areas = self.areas_towards(gone).into_iter();
            let Some((into, _)) = areas.reduce(|a, b| if b.1 > a.1 { b } else { a }) else { continue };
            if let Ok(place) = self.join(gone, into) {
                self.note(EventKind::Vanished, place, [gone]);
                joined.push((gone, into));
            }
        }
        joined
    }

    /// The regions that share film with a region, ascending, with the area of it, m^2.
    fn areas_towards(&self, region: Region) -> BTreeMap<Region, f64> {
        let mut areas = BTreeMap::new();
        for row in self.faces_where(|face| face.borders(region)) {
            let [back, front] = self.surface.mesh.face(row).labels();
            *areas.entry(if back == region { front } else { back }).or_insert(0.0) += self.surface.area(row);
        }
        areas
    }

    /// Takes away the film between two regions, and names all that was `gone` `into`.
    fn join(&mut self, gone: Region, into: Region) -> Result<DVec3, BurstRefused> {
        if gone == Region::OUTSIDE || self.surface.is_open(gone) && !self.surface.is_open(into) {
            return Err(BurstRefused::Outside(into));
        }
        let films: Vec<FaceRow> = self.faces_where(|face| face.borders(gone) && face.borders(into));
        let area: f64 = films.iter().map(|row| self.surface.area(*row)).sum();
        if films.is_empty() {
            return Err(BurstRefused::NoFilm(gone, into));
        }
        let middle = |row: &FaceRow| self.surface.corners(*row).iter().sum::<DVec3>() / 3.0 * self.surface.area(*row);
        let place = films.iter().map(middle).sum::<DVec3>() / area;
        let plan = Plan { removed: SmallVec::from_vec(films), joined: Some((gone, into)), ..Plan::default() };
        // Labels first: data sees the surface as it is afterwards.
        for row in self.faces_where(|face| face.borders(gone) && !face.borders(into)) {
            self.surface.mesh.relabel(row, |label| if label == gone { into } else { label });
        }
        self.commit(&plan);
        Ok(place)
    }

    fn faces_where(&self, wanted: impl Fn(&Face) -> bool) -> Vec<FaceRow> {
        self.surface.mesh.faces().filter(|(_, face)| wanted(face)).map(|(row, _)| row).collect()
    }
}
