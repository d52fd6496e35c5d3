//! Tables for polynomials in three variables up to an order: which power is where, and what comes of products.
//!
//! Powers `x^i y^j z^k` stand by degree, within a degree by falling `i`, then by falling `j`. An expansion of order p truncates by
//! the sum of degrees: moments of degree n meet local coefficients up to degree p - n, which leaves the interaction symmetric.

/// Exponents of a power.
type Power = [usize; 3];

/// How a power follows from one of a lower degree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Growth {
    /// The power with one factor less.
    pub(super) parent: u16,
    /// The factor's axis.
    pub(super) axis: u8,
    /// One over the factor's exponent: powers are divided by factorials.
    pub(super) scale: f64,
}

/// One step of the recurrence for derivatives of a radial function,
/// `R⁽ⁿ⁾[γ + e] = x_e R⁽ⁿ⁺¹⁾[γ] + γ_e R⁽ⁿ⁺¹⁾[γ - e]` with `R⁽ⁿ⁾[0] = (2 d/ds)ⁿ f`; `R⁽⁰⁾[γ]` is `∂^γ f`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Derivation {
    pub(super) to: u16,
    pub(super) axis: u8,
    pub(super) from: u16,
    pub(super) lower: u16,
    pub(super) factor: f64,
}

/// Tables of one order.
#[derive(Debug)]
pub(super) struct Taylor {
    /// Number of powers up to the order.
    pub(super) count: usize,
    /// For powers from the second on.
    pub(super) growth: Vec<Growth>,
    /// Steps to the derivatives, in order.
    pub(super) derivations: Vec<Derivation>,
    /// Where `R⁽ⁿ⁾` begins.
    pub(super) levels: Vec<usize>,
    /// Numbers in all levels.
    pub(super) scratch: usize,
    /// For each power, where the powers with one factor more along x, y, z are; only below the order.
    pub(super) raised: Vec<[u16; 3]>,
    /// Row starts of `products`, one more than powers.
    rows: Vec<usize>,
    /// For each power a the places of `a + b` for all b that keep the degree within the order.
    products: Vec<u16>,
}

/// Powers of degree below n.
const fn below(n: usize) -> usize {
    n * (n + 1) * (n + 2) / 6
}

/// Place of a power.
fn place([i, j, k]: Power) -> usize {
    let m = j + k;
    below(i + m) + m * (m + 1) / 2 + k
}

fn powers(order: usize) -> Vec<Power> {
    let of_degree = |n: usize| (0..=n).flat_map(move |m| (0..=m).map(move |k| [n - m, m - k, k]));
    (0..=order).flat_map(of_degree).collect()
}

fn sum(a: Power, b: Power) -> Power {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn unit(axis: usize) -> Power {
    let mut power = [0; 3];
    power[axis] = 1;
    power
}

/// The power's axis of least exponent, zeros aside: the shortest way down.
fn thinnest_axis(power: Power) -> usize {
    (0..3).filter(|axis| power[*axis] > 0).min_by_key(|axis| power[*axis]).expect("invariant: not the constant")
}

fn lowered(mut power: Power, axis: usize) -> Power {
    power[axis] -= 1;
    power
}

impl Taylor {
    pub(super) fn new(order: usize) -> Self {
        let powers = powers(order);
        let (levels, scratch) = levels(order);
        let rows_of = |a: &Power| below(order - a.iter().sum::<usize>() + 1);
        let mut rows = vec![0];
        rows.extend(powers.iter().scan(0, |end, a| {
            *end += rows_of(a);
            Some(*end)
        }));
        let products = powers.iter().flat_map(|a| powers[..rows_of(a)].iter().map(|b| place(sum(*a, *b)) as u16));
        Self {
            count: powers.len(),
            growth: powers[1..].iter().map(growth).collect(),
            derivations: derivations(&powers, &levels),
            levels,
            scratch,
            raised: powers[..below(order)].iter().map(raised).collect(),
            rows,
            products: products.collect(),
        }
    }

    /// Places of `a + b`, for b from the first power on.
    #[inline(always)]
    pub(super) fn products(&self, a: usize) -> &[u16] {
        &self.products[self.rows[a]..self.rows[a + 1]]
    }

    /// `v^β/β!` for all powers.
    pub(super) fn monomials(&self, v: [f64; 3], out: &mut Vec<f64>) {
        out.clear();
        out.push(1.0);
        for Growth { parent, axis, scale } in &self.growth {
            out.push(out[*parent as usize] * v[*axis as usize] * scale);
        }
    }
}

/// Where each level begins, and the end of the last: level n holds the powers up to the degree `order - n`.
fn levels(order: usize) -> (Vec<usize>, usize) {
    let mut end = 0;
    let starts = (0..=order).map(|n| {
        let start = end;
        end += below(order - n + 1);
        start
    });
    (starts.collect(), end)
}

fn growth(power: &Power) -> Growth {
    let axis = thinnest_axis(*power);
    let parent = place(lowered(*power, axis)) as u16;
    Growth { parent, axis: axis as u8, scale: 1.0 / power[axis] as f64 }
}

fn raised(power: &Power) -> [u16; 3] {
    [0, 1, 2].map(|axis| place(sum(*power, unit(axis))) as u16)
}

fn derivations(powers: &[Power], levels: &[usize]) -> Vec<Derivation> {
    let order = levels.len() - 1;
    let step = |power: &Power, n: usize| {
        let axis = thinnest_axis(*power);
        let from = lowered(*power, axis);
        let above = levels[n + 1];
        let lower = if from[axis] > 0 { lowered(from, axis) } else { from };
        Derivation {
            to: (levels[n] + place(*power)) as u16,
            axis: axis as u8,
            from: (above + place(from)) as u16,
            lower: (above + place(lower)) as u16,
            factor: from[axis] as f64,
        }
    };
    let of_degree = |degree: usize| {
        let of_degree = &powers[below(degree)..below(degree + 1)];
        (0..=order - degree).flat_map(move |n| of_degree.iter().map(move |power| (power, n)))
    };
    (1..=order).flat_map(of_degree).map(|(power, n)| step(power, n)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::accuracy::HIGHEST_ORDER;
    use super::*;

    #[test]
    fn places_count_up() {
        for (i, power) in powers(HIGHEST_ORDER).into_iter().enumerate() {
            assert_eq!(place(power), i);
        }
    }

    #[test]
    fn products_meet_within_the_order() {
        let taylor = Taylor::new(4);
        let powers = powers(4);
        assert_eq!(taylor.count, 35);
        // One product for every pair of powers whose degrees sum to at most 4: C(10, 6).
        assert_eq!(taylor.products.len(), 210);
        for (a, power) in powers.iter().enumerate() {
            for (b, product) in taylor.products(a).iter().enumerate() {
                assert_eq!(powers[*product as usize], sum(*power, powers[b]));
            }
        }
    }

    #[test]
    fn monomials_are_powers_over_factorials() {
        let mut found = vec![];
        let v = [0.3, -1.2, 0.7];
        Taylor::new(5).monomials(v, &mut found);
        let factorial = |n: usize| (1..=n).product::<usize>() as f64;
        for (power, found) in powers(5).iter().zip(found) {
            let expected: f64 = (0..3).map(|i| v[i].powi(power[i] as i32) / factorial(power[i])).product();
            assert!((found - expected).abs() < 1e-15, "{power:?}");
        }
    }
}
