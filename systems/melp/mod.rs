//! Moving Eulerian-Lagrangian particles (Deng et al. 2022), one file per stage.
//!
//! | stage | file | paper |
//! |---|---|---|
//! | step length | [`step_length`] | §6.3 (CFL) |
//! | L2E transfer | [`gather`], weights in [`links`], neighbours in [`tiles`] | Algorithm 1, Eqs 6, 7 |
//! | thickness, pressure | [`measure`] | Algorithm 2, Eqs 8, 9, 11 |
//! | normal dynamics | [`normal_motion`] | Algorithm 3, Eq. 12 |
//! | regions: contact, shared tension | [`contact`], near films in [`near_films`], implicit part in [`normal_system`] | section 5 |
//! | Marangoni solve | [`marangoni`], [`inertia`] | Algorithm 3, Eqs 14, 15 |
//! | E2L transfer | [`scatter`] | Algorithm 4, Eqs 16 to 18 |
//! | E advance, redistribution | [`carriers`], [`redistribution`] | Algorithms 5, 6, Eqs 19, 20 |
//! | L advance, projection | [`material`] | Algorithm 7, §4.8 |
//!
//! Carriers are Eulerian particles (E), material particles Lagrangian ones (L).

pub mod carriers;
pub mod contact;
pub mod discretise;
pub mod frames;
pub mod gather;
pub mod inertia;
pub mod links;
pub mod marangoni;
pub mod material;
pub mod measure;
pub mod near_films;
pub mod normal_motion;
pub mod normal_system;
pub mod observe;
pub mod redistribution;
pub mod scatter;
pub mod settings;
pub mod sorting;
pub mod state;
pub mod step_length;
pub mod tiles;
