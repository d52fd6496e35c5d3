//! Films that move by geometric flow and keep their mesh: the pieces of the crate put together as a method does.

#![allow(dead_code, reason = "every test uses another part")]

use froth_surface::corners::LeastAngles;
use froth_surface::flow::shape_keeping::{LEAST_PART, even_part};
use froth_surface::flow::{Flow, FlowState, Forcing, Motion, Scheme, Settings, Tangential};
use froth_surface::motion::{MotionReport, MotionSettings, advance};
use froth_surface::smoothing::tangential_displacements;
use froth_surface::transfer::{Columns, Transfer};
use froth_surface::{Event, LabelledTriangles, Policy, Region, Remeshed, Surface, Tracker};
use glam::DVec3;

/// Film tension of all tests, N/m; mobility 1 m/(s Pa): a film of curvature 1/m moves at 1 m/s.
pub(crate) const TENSION: f64 = 1.0;

pub(crate) struct Films {
    pub(crate) surface: Surface,
    pub(crate) tracker: Tracker,
    pub(crate) policy: Policy,
    pub(crate) flow: Flow,
    pub(crate) state: FlowState,
    pub(crate) settings: Settings,
    pub(crate) dt: f64,
    pub(crate) smoothing: f64,
    pub(crate) events: Vec<Event>,
    pub(crate) report: Option<MotionReport>,
    pub(crate) targets: Option<Vec<DVec3>>,
    /// Where a held vertex goes in one step.
    pub(crate) pull: Option<fn(DVec3) -> DVec3>,
}

impl Films {
    pub(crate) fn new(triangles: &LabelledTriangles, edge: f64, dt: f64) -> Self {
        let surface = Surface::from_triangles(triangles);
        let state = FlowState::at_rest(&surface);
        let policy = Policy { flips: true, ..Policy::new(edge) };
        let settings = Settings {
            motion: Motion::Overdamped { mobility: 1.0 },
            scheme: Scheme::Implicit,
            tangential: Tangential::Keep,
            ..Settings::default()
        };
        Self {
            surface,
            tracker: Tracker::default(),
            policy,
            flow: Flow::default(),
            state,
            settings,
            dt,
            smoothing: 0.2,
            events: Vec::new(),
            report: None,
            targets: None,
            pull: None,
        }
    }

    pub(crate) fn remesh(&mut self) -> Remeshed {
        let velocities = self.state.velocities.iter().flat_map(|u| u.to_array()).collect();
        let mut columns = Columns::new(3, velocities);
        let done = self.tracker.remesh(&mut self.surface, &self.policy, &mut columns as &mut dyn Transfer);
        self.state.velocities.0 = columns.values().chunks_exact(3).map(DVec3::from_slice).collect();
        for division in &done.divisions {
            let target = self.state.target_volumes.get(&division.from).copied();
            if let Some(target) = target {
                let whole = division.volume + division.rest;
                self.state.target_volumes.insert(division.to, target * division.volume / whole);
                self.state.target_volumes.insert(division.from, target * division.rest / whole);
            }
        }
        self.state.adopt_regions(&self.surface);
        self.events.extend(done.events.iter().cloned());
        done
    }

    /// Bursts the `n`-th film between two gas regions, if there is any.
    pub(crate) fn burst_one(&mut self, n: usize) {
        let mut walls: Vec<[Region; 2]> = self.surface.mesh.faces().map(|(_, face)| face.labels()).collect();
        walls.iter_mut().for_each(|wall| wall.sort_unstable());
        walls.sort_unstable();
        walls.dedup();
        walls.retain(|[a, _]| !self.surface.is_open(*a));
        let Some([into, gone]) = walls.get(n % walls.len().max(1)).copied() else { return };
        let whole = self.surface.volumes()[gone.index()];
        let velocities = self.state.velocities.iter().flat_map(|u| u.to_array()).collect();
        let mut columns = Columns::new(3, velocities);
        let mut session = self.tracker.begin(&mut self.surface, &self.policy, &mut columns);
        session.burst(gone, into).unwrap();
        self.tracker.close_up(&mut self.surface, &mut columns);
        self.state.velocities.0 = columns.values().chunks_exact(3).map(DVec3::from_slice).collect();
        if let Some(target) = self.state.target_volumes.get_mut(&into) {
            *target += whole;
        }
        self.state.adopt_regions(&self.surface);
    }

    /// Moves the films for at most `left` seconds, for as long as faces keep their shapes; gives the time that has passed.
    pub(crate) fn move_films(&mut self, left: f64) -> f64 {
        self.flow.rebuild(&self.surface);
        let mut length = left;
        let mut proposed = self.propose(length);
        for _ in 0..8 {
            let part = even_part(&self.surface, &proposed);
            if part >= 1.0 || length <= LEAST_PART * self.dt {
                break;
            }
            length = (part * length).max(LEAST_PART * self.dt).min(left);
            proposed = self.propose(length);
        }
        let motion = MotionSettings::new(self.policy.edge);
        self.report = Some(advance(&mut self.surface, &proposed, &motion));
        self.flow.finish(&self.surface.positions, length, &mut self.state);
        length
    }

    /// Where flow and smoothing take the films in a time.
    fn propose(&mut self, length: f64) -> Vec<DVec3> {
        if let Some(pull) = self.pull {
            let part = length / self.dt;
            self.targets = Some(self.surface.positions.iter().map(|x| x.lerp(pull(*x), part)).collect());
        }
        let forcing = Forcing { targets: self.targets.as_deref(), ..Forcing::uniform(TENSION, 1.0) };
        self.flow.propose(&self.surface, &self.state, &forcing, &self.settings, length).unwrap();
        let smoothing = tangential_displacements(&self.surface, self.smoothing, 0.1 * self.policy.edge);
        self.flow.proposal().positions.iter().zip(smoothing.iter()).map(|(x, d)| *x + *d).collect()
    }

    /// A step of [`Self::dt`], in as many pieces as the shapes of faces ask for, each after a pass of remeshing; `watch` sees the films after
    /// every pass, with what it did, and after every motion.
    pub(crate) fn step(&mut self, mut watch: impl FnMut(&Self, Option<&Remeshed>)) {
        const ROUNDING: f64 = 1e-9;
        let mut left = self.dt;
        while left > ROUNDING * self.dt {
            let done = self.remesh();
            watch(self, Some(&done));
            left -= self.move_films(left);
            watch(self, None);
        }
    }
}

/// Least angles of all films, degrees, and how many faces have one below 20: of films' own corners, and of others.
pub(crate) fn least_angles(surface: &Surface) -> (LeastAngles, [usize; 2]) {
    let films = surface.mesh.faces().filter(|(_, face)| !face.is_ghost());
    let angles = films.map(|(row, _)| LeastAngles::NONE.with_face_of(surface, row));
    let degrees = angles.map(|face| LeastAngles { own: face.own.to_degrees(), rest: face.rest.to_degrees() });
    degrees.fold((LeastAngles::NONE, [0; 2]), |(least, low), face| {
        (least.min(face), [low[0] + usize::from(face.own < 20.0), low[1] + usize::from(face.rest < 20.0)])
    })
}
