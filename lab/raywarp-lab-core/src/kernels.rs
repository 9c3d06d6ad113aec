//! What of the laboratory can be launched: kernels of the product over structures that it does not have, and kernels of its
//! own.

use raywarp_core::kernels::{Kernel, Thread};
use raywarp_core::view::Plain;

/// Gives `$use` the list of the laboratory's kernels with the names of their entry points. Its PTX has these and no others.
#[macro_export]
macro_rules! for_each_lab_kernel {
    ($use:ident) => {
        $crate::for_each_own_kernel! {
            $use,
            whitted_bvh2c: $crate::product::kernels::Whitted<$crate::product::traversal::QuantizedBvh2, $crate::product::traversal::NullStatistics>,
            whitted_bvh2c_counted: $crate::product::kernels::Whitted<$crate::product::traversal::QuantizedBvh2, $crate::product::traversal::Tests>,
            first_hits_bvh2c: $crate::product::kernels::FirstHits<$crate::product::traversal::QuantizedBvh2>,
            closest_bvh2c: $crate::product::kernels::Closest<$crate::product::traversal::QuantizedBvh2>,
            occluded_bvh2c: $crate::product::kernels::Occluded<$crate::product::traversal::QuantizedBvh2>,
            count_bvh2c: $crate::product::kernels::Count<$crate::product::traversal::QuantizedBvh2>,
            all_bvh2c: $crate::product::kernels::All<$crate::product::traversal::QuantizedBvh2>,
            whitted_kdtrail: $crate::product::kernels::Whitted<$crate::structures::KdTrail, $crate::product::traversal::NullStatistics>,
            whitted_bvh4: $crate::product::kernels::Whitted<$crate::structures::Bvh4, $crate::product::traversal::NullStatistics>,
            whitted_bvh8: $crate::product::kernels::Whitted<$crate::structures::Bvh8, $crate::product::traversal::NullStatistics>,
            whitted_bvh8w: $crate::product::kernels::Whitted<$crate::structures::Bvh8w, $crate::product::traversal::NullStatistics>,
            whitted_bvh8f: $crate::product::kernels::Whitted<$crate::product::traversal::Bvh8f, $crate::product::traversal::NullStatistics>,
            whitted_staged: $crate::product::kernels::Whitted<$crate::structures::Staged, $crate::product::traversal::NullStatistics>,
            whitted_kdtrail_counted: $crate::product::kernels::Whitted<$crate::structures::KdTrail, $crate::product::traversal::Tests>,
            whitted_bvh4_counted: $crate::product::kernels::Whitted<$crate::structures::Bvh4, $crate::product::traversal::Tests>,
            whitted_bvh8_counted: $crate::product::kernels::Whitted<$crate::structures::Bvh8, $crate::product::traversal::Tests>,
            whitted_bvh8w_counted: $crate::product::kernels::Whitted<$crate::structures::Bvh8w, $crate::product::traversal::Tests>,
            whitted_bvh8f_counted: $crate::product::kernels::Whitted<$crate::product::traversal::Bvh8f, $crate::product::traversal::Tests>,
            whitted_staged_counted: $crate::product::kernels::Whitted<$crate::structures::Staged, $crate::product::traversal::Tests>,
            first_hits_kdtrail: $crate::product::kernels::FirstHits<$crate::structures::KdTrail>,
            first_hits_bvh4: $crate::product::kernels::FirstHits<$crate::structures::Bvh4>,
            first_hits_bvh8: $crate::product::kernels::FirstHits<$crate::structures::Bvh8>,
            first_hits_bvh8w: $crate::product::kernels::FirstHits<$crate::structures::Bvh8w>,
            first_hits_bvh8f: $crate::product::kernels::FirstHits<$crate::product::traversal::Bvh8f>,
            first_hits_staged: $crate::product::kernels::FirstHits<$crate::structures::Staged>,
            closest_kdtrail: $crate::product::kernels::Closest<$crate::structures::KdTrail>,
            closest_bvh4: $crate::product::kernels::Closest<$crate::structures::Bvh4>,
            closest_bvh8: $crate::product::kernels::Closest<$crate::structures::Bvh8>,
            closest_bvh8w: $crate::product::kernels::Closest<$crate::structures::Bvh8w>,
            closest_bvh8f: $crate::product::kernels::Closest<$crate::product::traversal::Bvh8f>,
            closest_staged: $crate::product::kernels::Closest<$crate::structures::Staged>,
            occluded_kdtrail: $crate::product::kernels::Occluded<$crate::structures::KdTrail>,
            occluded_bvh4: $crate::product::kernels::Occluded<$crate::structures::Bvh4>,
            occluded_bvh8: $crate::product::kernels::Occluded<$crate::structures::Bvh8>,
            occluded_bvh8w: $crate::product::kernels::Occluded<$crate::structures::Bvh8w>,
            occluded_bvh8f: $crate::product::kernels::Occluded<$crate::product::traversal::Bvh8f>,
            occluded_staged: $crate::product::kernels::Occluded<$crate::structures::Staged>,
            count_kdtrail: $crate::product::kernels::Count<$crate::structures::KdTrail>,
            count_bvh4: $crate::product::kernels::Count<$crate::structures::Bvh4>,
            count_bvh8: $crate::product::kernels::Count<$crate::structures::Bvh8>,
            count_bvh8w: $crate::product::kernels::Count<$crate::structures::Bvh8w>,
            count_bvh8f: $crate::product::kernels::Count<$crate::product::traversal::Bvh8f>,
            count_staged: $crate::product::kernels::Count<$crate::structures::Staged>,
            all_kdtrail: $crate::product::kernels::All<$crate::structures::KdTrail>,
            all_bvh4: $crate::product::kernels::All<$crate::structures::Bvh4>,
            all_bvh8: $crate::product::kernels::All<$crate::structures::Bvh8>,
            all_bvh8w: $crate::product::kernels::All<$crate::structures::Bvh8w>,
            all_bvh8f: $crate::product::kernels::All<$crate::product::traversal::Bvh8f>,
            all_staged: $crate::product::kernels::All<$crate::structures::Staged>,
            whitted_brute_clocked: $crate::product::kernels::Whitted<$crate::product::traversal::Brute, $crate::clocks::Clocks>,
            whitted_kd_clocked: $crate::product::kernels::Whitted<$crate::product::traversal::KdTree, $crate::clocks::Clocks>,
            whitted_bvh2_clocked: $crate::product::kernels::Whitted<$crate::product::traversal::Bvh2, $crate::clocks::Clocks>,
        }
    };
}

/// As [`for_each_lab_kernel`], of these kernels and those whose parameter blocks are the laboratory's own.
#[doc(hidden)]
#[macro_export]
macro_rules! for_each_own_kernel {
    ($use:ident, $($others:tt)*) => {
        $use! {
            $($others)*
            closest_ifif: $crate::sharing::direct::Direct<$crate::sharing::form::IfIf, $crate::product::traversal::query::ClosestHit>,
            closest_whilewhile: $crate::sharing::direct::Direct<$crate::sharing::form::WhileWhile, $crate::product::traversal::query::ClosestHit>,
            closest_speculative: $crate::sharing::direct::Direct<$crate::sharing::form::Speculative, $crate::product::traversal::query::ClosestHit>,
            closest_postponed: $crate::sharing::direct::Direct<$crate::sharing::form::Postponed, $crate::product::traversal::query::ClosestHit>,
            closest_queued: $crate::sharing::queued::Queued<$crate::product::traversal::query::ClosestHit>,
            closest_refill: $crate::sharing::refill::Refill<$crate::sharing::form::WhileWhile, $crate::product::traversal::query::ClosestHit>,
            closest_refill_speculative: $crate::sharing::refill::Refill<$crate::sharing::form::Speculative, $crate::product::traversal::query::ClosestHit>,
            occluded_ifif: $crate::sharing::direct::Direct<$crate::sharing::form::IfIf, $crate::product::traversal::query::AnyHit>,
            occluded_whilewhile: $crate::sharing::direct::Direct<$crate::sharing::form::WhileWhile, $crate::product::traversal::query::AnyHit>,
            occluded_speculative: $crate::sharing::direct::Direct<$crate::sharing::form::Speculative, $crate::product::traversal::query::AnyHit>,
            occluded_postponed: $crate::sharing::direct::Direct<$crate::sharing::form::Postponed, $crate::product::traversal::query::AnyHit>,
            occluded_queued: $crate::sharing::queued::Queued<$crate::product::traversal::query::AnyHit>,
            occluded_refill: $crate::sharing::refill::Refill<$crate::sharing::form::WhileWhile, $crate::product::traversal::query::AnyHit>,
            occluded_refill_speculative: $crate::sharing::refill::Refill<$crate::sharing::form::Speculative, $crate::product::traversal::query::AnyHit>,
            paths: $crate::sharing::paths::Paths,
            bounce: $crate::sharing::paths::Bounce,
            sort_tell: $crate::sharing::sort::Tell,
            sort_sum: $crate::sharing::sort::Sum,
            sort_begin: $crate::sharing::sort::Begin,
            sort_move: $crate::sharing::sort::Move,
        }
    };
}

macro_rules! implement {
    ($($name:ident: $kernel:ty),* $(,)?) => {$(
        // SAFETY: `for_each_lab_kernel` gives the PTX its entry points by the same names and types.
        unsafe impl Kernel for $kernel {
            const NAME: &'static str = stringify!($name);
            #[inline(always)]
            unsafe fn thread(&self, thread: Thread) {
                self.run(thread)
            }
        }
    )*};
}

for_each_own_kernel!(implement,);

macro_rules! names {
    ($($name:ident: $kernel:ty),* $(,)?) => {
        /// Every entry point of the laboratory's PTX.
        pub const NAMES: &[&str] = &[$(stringify!($name)),*];
    };
}

for_each_lab_kernel!(names);

macro_rules! plain {
    ($($item:ty),* $(,)?) => {$(
        // SAFETY: a `repr(C)` type of 4-byte numbers that fill it without gaps.
        unsafe impl Plain for $item {}
    )*};
}

plain!(
    crate::clocks::StageTimes,
    crate::sharing::paths::Trail,
    crate::sharing::paths::Waiting,
    crate::structures::bvh4::Node,
    crate::structures::bvh8::Node,
    crate::structures::bvh8w::Node,
);

#[cfg(test)]
mod tests {
    use raywarp_core::kernels::Kernel;

    macro_rules! check {
        ($($name:ident: $kernel:ty),* $(,)?) => {
            #[test]
            fn kernels_have_the_names_of_their_entry_points() {
                $(assert_eq!(<$kernel as Kernel>::NAME, stringify!($name));)*
            }
        };
    }

    for_each_lab_kernel!(check);
}
