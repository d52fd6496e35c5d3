//! Burst of a film: the region behind it joins the one in front.
//!
//! Every face between the two regions goes, every other face of the region that burst takes the label of the one it joined. Curves
//! where three films met become part of one film; vertices that keep no face vanish.
//! Limits: the whole film goes at once; a hole with a retracting rim is not modelled.

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
        self.counts.bursts += 1;
        self.commit(&plan);
        self.note(EventKind::Burst, place, [gone, into]);
        Ok(place)
    }

    fn faces_where(&self, wanted: impl Fn(&Face) -> bool) -> Vec<FaceRow> {
        self.surface.mesh.faces().filter(|(_, face)| wanted(face)).map(|(row, _)| row).collect()
    }
}
