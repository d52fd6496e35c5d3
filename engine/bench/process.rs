//! Processor time and memory of this process, as Linux tells them.

use std::fs;
use std::time::Duration;

/// Time that all living threads have spent on processors, user and system.
#[must_use]
pub fn processor_time() -> Option<Duration> {
    let threads = fs::read_dir("/proc/self/task").ok()?;
    let times = threads.flatten().map(|thread| fs::read_to_string(thread.path().join("schedstat")).ok());
    times.map(|text| on_processor(&text?)).sum()
}

/// The first number of `schedstat`, nanoseconds on a processor.
fn on_processor(schedstat: &str) -> Option<Duration> {
    schedstat.split_whitespace().next()?.parse().ok().map(Duration::from_nanos)
}

/// Largest resident memory of this process since its start or the last [`reset_peak`], bytes.
#[must_use]
pub fn peak_bytes() -> Option<u64> {
    peak_in(&fs::read_to_string("/proc/self/status").ok()?)
}

/// The line `VmHWM:  12345 kB`.
fn peak_in(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kilobytes)
}

/// Forgets the peak so far. Where the system refuses, the peak remains that of the whole process.
pub fn reset_peak() {
    let _ = fs::write("/proc/self/clear_refs", "5");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_and_memory_are_read() {
        assert_eq!(on_processor("1500 20 3\n"), Some(Duration::from_nanos(1500)));
        assert_eq!(peak_in("VmPeak:\t 9 kB\nVmHWM:\t  2048 kB\n"), Some(2 << 20));
        assert_eq!(peak_in("nothing"), None);
    }
}
