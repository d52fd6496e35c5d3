//! Measured numbers: one row per step, one column per name.

use bevy_ecs::resource::Resource;
use serde::{Deserialize, Serialize};

/// Numbers that systems measure in the present step. Columns keep the order in which their names first appear.
///
/// The columns are part of the state of a run, so that a resumed run writes them in the same order; the values are not.
#[derive(Resource, Clone, Debug, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Observables {
    columns: Vec<Observable>,
}

/// One measured quantity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Observable {
    /// Name, unique in a run.
    pub name: String,
    /// SI unit, `"1"` for a dimensionless number.
    pub unit: String,
    /// Value in the present step; `None` before it is recorded.
    #[serde(skip)]
    pub value: Option<f64>,
}

impl Observables {
    /// Records the value of the present step; a second one in the same step replaces the first.
    pub fn record(&mut self, name: &str, unit: &str, value: f64) {
        match self.columns.iter_mut().find(|column| column.name == name) {
            Some(column) => column.value = Some(value),
            None => {
                let (name, unit) = (name.to_owned(), unit.to_owned());
                self.columns.push(Observable { name, unit, value: Some(value) });
            }
        }
    }

    /// Adds to the value of the present step: for what every substep adds to.
    pub fn add(&mut self, name: &str, unit: &str, value: f64) {
        self.record(name, unit, self.get(name).unwrap_or(0.0) + value);
    }

    /// Raises the value of the present step to `value` if that is larger or not a number: for the largest of all substeps.
    pub fn raise(&mut self, name: &str, unit: &str, value: f64) {
        let so_far = self.get(name).unwrap_or(value);
        self.record(name, unit, if value > so_far || value.is_nan() { value } else { so_far });
    }

    /// All quantities, in their order.
    #[must_use]
    pub fn columns(&self) -> &[Observable] {
        &self.columns
    }

    /// The value of the present step.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<f64> {
        self.columns.iter().find(|column| column.name == name)?.value
    }

    /// Forgets the values of the step before; the columns stay.
    pub fn begin_step(&mut self) {
        self.columns.iter_mut().for_each(|column| column.value = None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_keep_their_order_and_values_last_one_step() {
        let mut observables = Observables::default();
        observables.record("volume", "m^3", 1.0);
        observables.record("energy", "J", 2.0);
        observables.begin_step();
        observables.record("energy", "J", 3.0);
        let names: Vec<&str> = observables.columns().iter().map(|column| column.name.as_str()).collect();
        assert_eq!(names, ["volume", "energy"]);
        assert_eq!((observables.get("volume"), observables.get("energy")), (None, Some(3.0)));
    }

    #[test]
    fn substeps_add_up_or_leave_the_largest() {
        let mut observables = Observables::default();
        for value in [2.0, 3.0, 1.0] {
            observables.add("iterations", "1", value);
            observables.raise("largest", "1", value);
        }
        assert_eq!((observables.get("iterations"), observables.get("largest")), (Some(6.0), Some(3.0)));
        observables.raise("largest", "1", f64::NAN);
        assert!(observables.get("largest").unwrap().is_nan());
    }
}
