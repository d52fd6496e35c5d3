//! Contact: the T1 in which an edge gives way to a film.
//!
//! Where an edge of three films has shrunk to a vertex, two poles `P` and `Q` meet in it from above and below, and `k >= 3` sectors
//! `A_i` lie around. Besides pulling `P` and `Q` apart again there is a second way on: they come to share a small film with `k` corners,
//! to which the films `A_i | A_(i+1)` retract.
//!
//! ```text
//!       \  P  /               \   P   /            side view of three sectors around; B lies behind.
//!        \   /                 \     /
//!    A    >v<    C    ->   A    v1--v2    C        The film (v1, v2, v3) has P above and Q below; each corner v_i keeps the
//!        /   \                 /     \             faces of one film A_i | A_(i+1), and the fans of P | A_i and Q | A_i,
//!       /  Q  \               /   Q   \            which span from corner to corner, get one triangle more.
//! ```
//!
//! Discretisation: corners move out along their films, against the gradient of their area, until neighbours are as far apart as the two
//! vertices of a separation. Each fan takes its new triangle `(v_i, w, v_(i+1))` at the edge `(v, w)` that leaves the largest least angle.
//! Labels are those of the fan, and those of the new film follow from balance.
//! Limits: every edge of the vertex has at most three faces, and `P` and `Q` border every `A_i` in one film each.

use std::f64::consts::PI;

use glam::DVec3;
use smallvec::{SmallVec, smallvec};

use super::plan::{Added, Plan, add_labels, as_film};
use super::{Session, checks};
use crate::mesh::Face;
use crate::rows::{FaceRow, Region, VertexRow};
use crate::sectors::Sectors;
use crate::surface::Surface;
use crate::transfer::Blend;

/// One film of a vertex: its fan of faces `(v, w_j, w_(j+1))`.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Fan {
    /// The two sectors.
    sectors: [u16; 2],
    /// Faces in order.
    faces: SmallVec<[FaceRow; 4]>,
    /// Far ends `w_0, w_1, ...`: one more than faces.
    ends: SmallVec<[VertexRow; 4]>,
    /// Back and front in the winding `(v, w_j, w_(j+1))`.
    labels: [Region; 2],
}

impl Fan {
    fn reversed(mut self) -> Self {
        self.faces.reverse();
        self.ends.reverse();
        self.labels.reverse();
        self
    }

    fn first(&self) -> VertexRow {
        self.ends[0]
    }

    fn last(&self) -> VertexRow {
        self.ends[self.faces.len()]
    }

    fn has(&self, sector: u16) -> bool {
        self.sectors.contains(&sector)
    }
}

/// A vertex at which two poles meet and could come to share a film.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Contact {
    /// The two that would share a film.
    pub poles: [Region; 2],
    /// The sectors around, in cyclic order; they no longer meet in a point afterwards.
    pub around: SmallVec<[Region; 4]>,
    /// The films between neighbours around: `posts[i]` is between `around[i]` and `around[i + 1]`.
    posts: SmallVec<[Fan; 4]>,
    /// Per pole, the films between it and `around[i]`, from `posts[i - 1]` to `posts[i]`.
    roofs: [SmallVec<[Fan; 4]>; 2],
}

/// Ways in which sectors that meet at a vertex alone can come to share a film.
#[must_use]
pub fn contact_candidates(surface: &Surface, vertex: VertexRow) -> Vec<Contact> {
    let rows = surface.mesh.faces_of(vertex);
    let faces: SmallVec<[Face; 16]> = rows.iter().map(|row| surface.mesh.face(*row)).collect();
    let sectors = Sectors::of(vertex, &faces, &|v| surface.positions[v]);
    if sectors.is_tangled() || sectors.components() != 1 || sectors.count() < 5 {
        return Vec::new();
    }
    let Some(fans) = fans(surface, vertex, &sectors) else { return Vec::new() };
    let count = sectors.count() as u16;
    let pairs = (0..count).flat_map(|q| (0..q).map(move |p| [p, q]));
    pairs.filter_map(|poles| prism(&sectors, &fans, poles)).collect()
}

/// The films of a vertex, each one fan; `None` where an edge has more than three faces, a film is a ghost, or two sectors share two films.
fn fans(surface: &Surface, vertex: VertexRow, sectors: &Sectors) -> Option<Vec<Fan>> {
    let mesh = &surface.mesh;
    let rows = mesh.faces_of(vertex);
    if rows.iter().any(|row| mesh.face(*row).is_ghost()) {
        return None;
    }
    let sides = |place: usize| {
        let [a, b] = sectors.sides(place);
        [a.min(b), a.max(b)]
    };
    let mut films: Vec<([u16; 2], FaceRow)> = rows.iter().enumerate().map(|(i, row)| (sides(i), *row)).collect();
    films.sort_unstable();
    let chunks = films.chunk_by(|x, y| x.0 == y.0);
    chunks.map(|film| fan(surface, vertex, film[0].0, film.iter().map(|(_, row)| *row).collect())).collect()
}

/// Puts the faces of one film in order.
fn fan(surface: &Surface, vertex: VertexRow, sectors: [u16; 2], mut rest: SmallVec<[FaceRow; 8]>) -> Option<Fan> {
    let mesh = &surface.mesh;
    let degree = |w: VertexRow| mesh.faces_of_edge(vertex, w).len();
    let mut rims = rest.iter().flat_map(|row| mesh.face(*row).around(vertex)).filter(|w| degree(*w) == 3);
    let start = rims.next()?;
    let mut fan = Fan { sectors, faces: smallvec![], ends: smallvec![start], labels: [Region::OUTSIDE; 2] };
    let mut at = start;
    while let Some(next) = rest.iter().position(|row| mesh.face(*row).has(at)) {
        let row = rest.remove(next);
        let face = mesh.face(row);
        if fan.faces.is_empty() {
            let [back, front] = face.labels();
            fan.labels = if face.around(vertex)[0] == at { [back, front] } else { [front, back] };
        }
        at = face.opposite(vertex, at);
        fan.faces.push(row);
        fan.ends.push(at);
        if degree(at) != 2 {
            break;
        }
    }
    (rest.is_empty() && degree(at) == 3 && at != start).then_some(fan)
}

/// The contact of two sectors, if all others lie around them in one ring.
fn prism(sectors: &Sectors, fans: &[Fan], [p, q]: [u16; 2]) -> Option<Contact> {
    let ring = sectors.count() - 2;
    let is_post = |fan: &&Fan| !fan.has(p) && !fan.has(q);
    if fans.len() != 3 * ring || fans.iter().any(|fan| fan.has(p) && fan.has(q)) {
        return None;
    }
    let mut rest: Vec<Fan> = fans.iter().filter(is_post).cloned().collect();
    let [start, mut next] = rest.first()?.sectors;
    let mut contact = Contact {
        poles: [p, q].map(|sector| sectors.region(sector)),
        around: smallvec![sectors.region(start)],
        posts: smallvec![rest.remove(0)],
        roofs: [smallvec![], smallvec![]],
    };
    let mut order: SmallVec<[u16; 4]> = smallvec![start];
    while next != start {
        let place = rest.iter().position(|fan| fan.has(next))?;
        let post = rest.remove(place);
        order.push(next);
        contact.around.push(sectors.region(next));
        next = if post.sectors[0] == next { post.sectors[1] } else { post.sectors[0] };
        contact.posts.push(post);
    }
    if order.len() != ring || !rest.is_empty() {
        return None;
    }
    for (side, pole) in [p, q].into_iter().enumerate() {
        for (i, around) in order.iter().enumerate() {
            let roof = fans.iter().find(|fan| fan.has(pole) && fan.has(*around))?;
            let (from, to) = (&contact.posts[(i + ring - 1) % ring], &contact.posts[i]);
            contact.roofs[side].push(from_to(roof, from, to)?);
        }
    }
    Some(contact)
}

/// A fan in the direction from one post to another.
fn from_to(roof: &Fan, from: &Fan, to: &Fan) -> Option<Fan> {
    let ends = |post: &Fan| [post.first(), post.last()];
    if ends(from).contains(&roof.first()) && ends(to).contains(&roof.last()) {
        Some(roof.clone())
    } else if ends(from).contains(&roof.last()) && ends(to).contains(&roof.first()) {
        Some(roof.clone().reversed())
    } else {
        None
    }
}

impl Session<'_> {
    /// The contact with neighbouring corners of the new film `side` metres apart.
    pub(super) fn plan_contact(&self, vertex: VertexRow, contact: &Contact, side: f64) -> Option<Plan> {
        let surface = &*self.surface;
        let corners = contact.posts.len();
        let radius = 0.5 * side / (PI / corners as f64).sin();
        let first_new = surface.mesh.vertex_rows() as u32;
        let row = |corner: usize| if corner == 0 { vertex } else { VertexRow(first_new + corner as u32 - 1) };
        let mut plan = Plan::default();
        for (corner, post) in contact.posts.iter().enumerate() {
            let place = surface.positions[vertex] + self.retreat(vertex, post)? * radius;
            if corner == 0 {
                plan.moved.push((vertex, place));
            } else {
                plan.created.push((place, false));
                plan.blends.push(Blend { vertex: row(corner), parents: smallvec![(vertex, 1.0)] });
            }
        }
        for (corner, post) in contact.posts.iter().enumerate() {
            self.hand_over(&mut plan, vertex, row(corner), &post.faces);
        }
        for (i, roof) in contact.roofs.iter().flat_map(|roofs| roofs.iter().enumerate()) {
            self.span(&mut plan, vertex, [row((i + corners - 1) % corners), row(i)], roof);
        }
        self.close_contact(&mut plan, contact, &row)?;
        plan.note_reshaped(surface);
        Some(plan)
    }

    /// The way in which the area of a film shrinks most when the vertex moves: a unit vector.
    fn retreat(&self, vertex: VertexRow, post: &Fan) -> Option<DVec3> {
        post.faces.iter().map(|row| self.pull(vertex, *row)).sum::<DVec3>().try_normalize()
    }

    /// Gives faces of the vertex to a corner.
    fn hand_over(&self, plan: &mut Plan, vertex: VertexRow, corner: VertexRow, faces: &[FaceRow]) {
        plan.sweep(self.surface, vertex, faces, plan.at(self.surface, corner));
        if corner == vertex {
            return;
        }
        for row in faces {
            plan.removed.push(*row);
            let face = self.surface.mesh.face(*row).with_replaced(vertex, corner);
            plan.added.push(Added { face, origin: Some(*row) });
        }
    }

    /// Makes a fan span from corner to corner, where the angles come out best.
    fn span(&self, plan: &mut Plan, vertex: VertexRow, [from, to]: [VertexRow; 2], roof: &Fan) {
        let at = |v: VertexRow| plan.at(self.surface, v);
        let least_angle = |split: usize| {
            let corner = |j: usize| if j < split { from } else { to };
            let fans = (0..roof.faces.len()).map(|j| [corner(j), roof.ends[j], roof.ends[j + 1]]);
            let triangles = fans.chain([[from, roof.ends[split], to]]).map(|triangle| triangle.map(at));
            checks::Shape::of(triangles).least_angle
        };
        let best = (0..=roof.faces.len()).max_by(|a, b| least_angle(*a).total_cmp(&least_angle(*b)));
        let split = best.expect("invariant: a fan has faces");
        self.hand_over(plan, vertex, from, &roof.faces[..split]);
        self.hand_over(plan, vertex, to, &roof.faces[split..]);
        let face = Face::new([from, roof.ends[split], to], roof.labels);
        plan.added.push(Added { face, origin: None });
    }

    /// Adds the film between the poles; `None` where its sides do not agree on it.
    fn close_contact(&self, plan: &mut Plan, contact: &Contact, row: &impl Fn(usize) -> VertexRow) -> Option<()> {
        let labels_at = |i: usize| {
            let mut balance = SmallVec::new();
            contact.roofs.iter().for_each(|roofs| add_labels(&mut balance, roofs[i].labels, 1));
            as_film(&balance).ok().flatten()
        };
        let labels = labels_at(0)?;
        if (1..contact.posts.len()).any(|i| labels_at(i) != Some(labels)) {
            return None;
        }
        for i in 1..contact.posts.len() - 1 {
            plan.added.push(Added { face: Face::new([row(0), row(i), row(i + 1)], labels), origin: None });
        }
        Some(())
    }
}
