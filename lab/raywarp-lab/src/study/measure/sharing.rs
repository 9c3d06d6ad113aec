//! Ways to share out a batch of rays among threads.

use raywarp::accel::Accel;
use raywarp::query::{Answers, PixelOrder, Workload};
use raywarp_lab::lanes::LoopForm;
use raywarp_lab::structures::Tree;
use raywarp_lab::{Batch, Queues, Way};

use super::rate;
use super::scene::Stage;
use crate::study::findings::Sharing;
use raywarp_cli::bench::Spread;
use raywarp_cli::failure::{ensure, fail, Result};

/// What everything is compared with.
const PLAIN: Way = Way::Direct(LoopForm::WhileWhile);

/// Every way, for every kind of rays: in each group the plain one first.
pub fn sharing(stage: &Stage) -> Result<Vec<Sharing>> {
    stage.say("sharing out the work");
    let mut rows = Vec::new();
    for workload in stage.workloads.iter().filter(|workload| !workload.rays.is_empty()) {
        // Those of the first way, which is the plain one.
        let mut expected = None;
        let mut group = |name: &str, ways: &[Variant]| -> Result<()> {
            let mut plain = None;
            for &(way, variant) in ways {
                let (speed, found) = time(stage, workload, variant)?;
                // In another order the answers are those of other places.
                ensure!(
                    variant.order != PixelOrder::Tiles || *expected.get_or_insert_with(|| found.clone()) == found,
                    "{} rays are answered differently by {way}: it is wrong; report it",
                    workload.kind
                );
                let (plain, median) = (*plain.get_or_insert(speed.median), speed.median);
                rows.push(Sharing {
                    group: name.to_owned(),
                    way: way.to_owned(),
                    rays: workload.kind.to_string(),
                    mrays_per_s: speed,
                    gain: median / plain,
                });
            }
            Ok(())
        };
        group("order of the rays", &ORDERS)?;
        group("threads a block", &BLOCKS)?;
        group("loop", &LOOPS)?;
        group("queue", &QUEUES)?;
    }
    Ok(rows)
}

/// What differs from the plain way.
#[derive(Clone, Copy)]
struct Choice {
    way: Way,
    order: PixelOrder,
    block: Option<u32>,
}

type Variant = (&'static str, Choice);

const fn by(way: Way) -> Choice {
    Choice { way, order: PixelOrder::Tiles, block: None }
}

const fn ordered(order: PixelOrder) -> Choice {
    Choice { order, ..by(PLAIN) }
}

const fn in_blocks(threads: u32) -> Choice {
    Choice { block: Some(threads), ..by(PLAIN) }
}

const ORDERS: [Variant; 3] = [
    ("tiles of 8x4 pixels", ordered(PixelOrder::Tiles)),
    ("scan line", ordered(PixelOrder::Scan)),
    ("Morton", ordered(PixelOrder::Morton)),
];

const BLOCKS: [Variant; 4] =
    [("64", in_blocks(64)), ("32", in_blocks(32)), ("128", in_blocks(128)), ("256", in_blocks(256))];

const LOOPS: [Variant; 4] = [
    ("while-while", by(PLAIN)),
    ("if-if", by(Way::Direct(LoopForm::IfIf))),
    ("speculative", by(Way::Direct(LoopForm::Speculative))),
    ("postponed", by(Way::Direct(LoopForm::Postponed))),
];

const QUEUES: [Variant; 6] = [
    ("one thread a ray", by(PLAIN)),
    ("persistent, global queue", by(Way::Queued(Queues::Global))),
    ("block queues, stealing", by(Way::Queued(Queues::Block))),
    ("warp queues, stealing", by(Way::Queued(Queues::Warp))),
    ("refill", by(Way::Refill)),
    ("refill, speculative", by(Way::RefillSpeculative)),
];

fn time(stage: &Stage, workload: &Workload, choice: Choice) -> Result<(Spread, Answers)> {
    let mut batch = match choice.order {
        PixelOrder::Tiles => batch(stage, workload)?,
        order => batch(stage, &stage.reordered(workload, order))?,
    };
    if let Some(threads) = choice.block {
        batch.set_block(threads)?;
    }
    let seconds = batch.time(choice.way, stage.setting.times)?;
    ensure!(batch.is_reset()?, "the queues of {:?} were not set back: its times are wrong; report it", choice.way);
    Ok((rate(workload.rays.len(), seconds), batch.answers()?))
}

fn batch(stage: &Stage, workload: &Workload) -> Result<Batch> {
    let Tree::Product(Accel::Bvh2(tree)) = &stage.tree else { fail!("the tree is no bvh2") };
    Ok(Batch::new(stage.setting.device, tree, &workload.rays, workload.kind.any_hit())?)
}
