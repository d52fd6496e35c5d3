//! Every two of many seats meet once, in rounds of disjoint pairs: parallel, and the same order at every seat for any number of
//! threads.
//!
//! The circle method: seats stand in two rows that face each other, the first stays, the others move on by one place after each
//! round. After all rounds everyone is back.
//!
//! ```text
//! round 0:  0 1 2      round 1:  0 5 1      round 2:  0 4 5
//!           5 4 3                4 3 2                3 2 1
//! ```

use rayon::prelude::*;

/// Calls `meet` once for every two seats. Their number must be even, or one.
pub(crate) fn meet_all<T: Send>(seats: &mut [T], meet: impl Fn(&mut T, &mut T) + Sync) {
    debug_assert!(seats.len() == 1 || seats.len().is_multiple_of(2));
    for _ in 1..seats.len() {
        let (left, right) = seats.split_at_mut(seats.len() / 2);
        left.par_iter_mut().zip(right.par_iter_mut().rev()).for_each(|(a, b)| meet(a, b));
        seats[1..].rotate_right(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_two_meet_once_and_all_return_to_their_seats() {
        for count in [0, 1, 2, 4, 10, 16] {
            let mut seats: Vec<(usize, Vec<usize>)> = (0..count).map(|i| (i, vec![i])).collect();
            meet_all(&mut seats, |a, b| {
                a.1.push(b.0);
                b.1.push(a.0);
            });
            for (i, (name, mut met)) in seats.into_iter().enumerate() {
                assert_eq!(name, i);
                met.sort_unstable();
                assert_eq!(met, (0..count).collect::<Vec<_>>());
            }
        }
    }
}
