//! How much memory there is, and a budget of it that is asked before anything is allocated by what a file says.
//!
//! Linux grants what is asked for and ends the program once it is used: what does not fit has to be found out before.

use std::fmt;
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::Arc;

/// Bytes that this process can still have without swapping: of the machine, of its control groups, and of its limit of
/// address space, the least. None where the system does not tell.
pub fn available() -> Option<u64> {
    let read = |path: &str| fs::read_to_string(path).ok();
    let machine = read("/proc/meminfo").and_then(|text| kibibytes(&text, "MemAvailable:"));
    let groups = read("/proc/self/cgroup").and_then(|text| of_groups(&text, Path::new("/sys/fs/cgroup")));
    let space =
        read("/proc/self/limits").zip(read("/proc/self/status")).and_then(|(limits, status)| space(&limits, &status));
    [machine, groups, space].into_iter().flatten().min()
}

/// The number behind a name in a table of the kernel, in kB there.
fn kibibytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse::<u64>().ok()?.checked_mul(1024)
}

/// What `ulimit -v` leaves; none without such a limit.
fn space(limits: &str, status: &str) -> Option<u64> {
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let most: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(most.saturating_sub(kibibytes(status, "VmSize:")?))
}

/// The least that the control groups of a process leave, those around its own included: of version 2, or of memory in
/// version 1.
fn of_groups(text: &str, root: &Path) -> Option<u64> {
    let group = |line: &str| {
        let (names, path) = line.split_once(':')?.1.split_once(':')?;
        let (root, files) = match names {
            "" => (root.to_owned(), ["memory.max", "memory.current"]),
            _ if names.split(',').any(|name| name == "memory") => {
                (root.join("memory"), ["memory.limit_in_bytes", "memory.usage_in_bytes"])
            }
            _ => return None,
        };
        // In a container the path may be the host's: then its own root is what there is.
        let own = root.join(path.trim_start_matches('/'));
        let around = own.ancestors().take_while(|folder| folder.starts_with(&root));
        around.filter_map(|folder| left_in(folder, files)).min()
    };
    text.lines().filter_map(group).min()
}

/// Of one group: its limit without what is in use and cannot be dropped.
fn left_in(folder: &Path, [limit, usage]: [&str; 2]) -> Option<u64> {
    let read = |name: &str| fs::read_to_string(folder.join(name)).ok();
    let number = |name: &str| read(name)?.trim().parse::<u64>().ok();
    let stat = read("memory.stat").unwrap_or_default();
    let named = |name: &str| stat.lines().find_map(|line| line.strip_prefix(name)?.trim().parse::<u64>().ok());
    // Pages of files that nobody used lately go first.
    let cached = named("inactive_file ").unwrap_or(0);
    Some(number(limit)?.saturating_sub(number(usage)?.saturating_sub(cached)))
}

/// Bytes that may still be taken, shared by all that read one scene.
#[derive(Clone, Debug)]
pub struct Budget(Arc<AtomicU64>);

/// What does not fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shortage {
    /// Bytes that are needed.
    pub needed: u64,
    /// Bytes that there are.
    pub free: u64,
}

impl Budget {
    /// Of so many bytes.
    pub fn of(bytes: u64) -> Self {
        Self(Arc::new(AtomicU64::new(bytes)))
    }

    /// Of what this process can have now; without a bound where the system does not tell.
    pub fn of_machine() -> Self {
        Self::of(available().unwrap_or(u64::MAX))
    }

    /// Bytes that are left.
    pub fn left(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }

    /// Takes bytes that stay in use.
    ///
    /// # Errors
    /// [`Shortage`] where they are not there; then none is taken.
    pub fn take(&self, needed: u64) -> Result<(), Shortage> {
        let taken = self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(needed));
        taken.map(drop).map_err(|free| Shortage { needed, free })
    }

    /// Asks for bytes that are used for a moment.
    ///
    /// # Errors
    /// [`Shortage`] where they are not there.
    pub fn fits(&self, needed: u64) -> Result<(), Shortage> {
        let free = self.left();
        (needed <= free).then_some(()).ok_or(Shortage { needed, free })
    }
}

/// What a growing list was given of a budget.
pub(crate) struct Growth {
    budget: Budget,
    taken: u64,
}

/// Bytes that are taken at a time.
const STEP: u64 = 1 << 20;
/// A list that grows has up to twice as much memory as it needs.
const GROWN: u64 = 2;

impl Growth {
    pub fn new(budget: &Budget) -> Self {
        Self { budget: budget.clone(), taken: 0 }
    }

    /// So many items of so many bytes are about to be there, all in all.
    #[inline]
    pub fn reach(&mut self, items: usize, bytes_each: usize) -> Result<(), Shortage> {
        let bytes = GROWN * items as u64 * bytes_each as u64;
        if bytes <= self.taken {
            return Ok(());
        }
        let more = (bytes - self.taken).max(STEP.min(self.budget.left()));
        self.budget.take(more).map_err(|shortage| Shortage { needed: bytes, free: self.taken + shortage.free })?;
        self.taken += more;
        Ok(())
    }
}

impl fmt::Display for Shortage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of memory needed, {} free", Bytes(self.needed), Bytes(self.free))
    }
}

/// For people.
struct Bytes(u64);

impl fmt::Display for Bytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const UNITS: [&str; 4] = ["KiB", "MiB", "GiB", "TiB"];
        if self.0 < 1024 {
            return write!(f, "{} bytes", self.0);
        }
        let power = (self.0.ilog2() / 10).min(4);
        write!(f, "{:.1} {}", self.0 as f64 / 1024f64.powi(power as i32), UNITS[power as usize - 1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_taken_is_gone_and_what_does_not_fit_is_not_taken() {
        let budget = Budget::of(10);
        let shared = budget.clone();
        assert_eq!((budget.take(4), shared.left(), shared.fits(6)), (Ok(()), 6, Ok(())));
        let shortage = Shortage { needed: 7, free: 6 };
        assert_eq!((shared.take(7), budget.fits(7), budget.left()), (Err(shortage), Err(shortage), 6));
        let large = Shortage { needed: 5 << 30, free: 3 << 19 };
        assert_eq!(large.to_string(), "5.0 GiB of memory needed, 1.5 MiB free");
    }

    #[test]
    fn lists_that_grow_take_steps() {
        let budget = Budget::of(5 << 20);
        let mut growth = Growth::new(&budget);
        assert_eq!((growth.reach(10, 12), budget.left()), (Ok(()), 4 << 20));
        assert_eq!((growth.reach(1000, 12), budget.left()), (Ok(()), 4 << 20));
        assert_eq!((growth.reach(1 << 20, 2), budget.left()), (Ok(()), 1 << 20));
        assert_eq!(growth.reach(3 << 20, 1), Err(Shortage { needed: 6 << 20, free: 5 << 20 }));
    }

    #[test]
    fn the_limits_of_the_system_are_found() {
        let meminfo = "MemTotal:       100 kB\nMemAvailable:    64 kB\n";
        assert_eq!(kibibytes(meminfo, "MemAvailable:"), Some(64 << 10));
        let limits = "Limit  Soft Limit  Hard Limit  Units\nMax address space         1048576     unlimited   bytes\n";
        assert_eq!(space(limits, "VmSize:\t     24 kB\n"), Some((1 << 20) - (24 << 10)));
        assert_eq!(space(&limits.replace("1048576 ", "unlimited"), "VmSize: 24 kB\n"), None);
        #[cfg(target_os = "linux")]
        assert!(available().is_some_and(|bytes| bytes > 1 << 20));
    }

    #[test]
    fn the_tightest_group_counts() {
        let root = tempfile::tempdir().unwrap();
        let put = |folder: &str, files: &[(&str, &str)]| {
            fs::create_dir_all(root.path().join(folder)).unwrap();
            files.iter().for_each(|(name, text)| fs::write(root.path().join(folder).join(name), text).unwrap());
        };
        put(
            "a",
            &[("memory.max", "1000\n"), ("memory.current", "900\n"), ("memory.stat", "anon 5\ninactive_file 300\n")],
        );
        put("a/b", &[("memory.max", "max\n"), ("memory.current", "900\n")]);
        assert_eq!(of_groups("0::/a/b\n", root.path()), Some(400));
        assert_eq!(of_groups("0::/elsewhere\n", root.path()), None);
        put("memory/c", &[("memory.limit_in_bytes", "700\n"), ("memory.usage_in_bytes", "100\n")]);
        assert_eq!(of_groups("5:cpu,memory:/c\n4:pids:/c\n", root.path()), Some(600));
        put(".", &[("memory.max", "50\n"), ("memory.current", "20\n")]);
        assert_eq!(of_groups("0::/host/path/that/is/not/here\n", root.path()), Some(30));
    }
}
