//! What happens in froth: one folder per subject, one file per stage; every system is a thin shell over pure functions.
