//! Results as people read them: Markdown.

use super::results::{PeerRow, Results, Row, Speed};
use crate::columns::{left, right, Column, Table};
use crate::messages;

impl Results {
    /// Tables and notes.
    pub fn table(&self) -> String {
        let [width, height] = self.size;
        let mut text = format!(
            "{}; picture {width}x{height}; median of {} after {} (least to most)\n",
            self.machine.sentence(),
            self.repeats,
            self.warmup
        );
        text += &table(&self.columns(), &self.rows);
        if !self.peers.is_empty() {
            text += &table(&self.peer_columns(), &self.peers);
        }
        if !self.notes.is_empty() {
            text += "\n";
        }
        self.notes.iter().for_each(|note| text += &format!("- {note}\n"));
        text
    }

    fn columns(&self) -> Vec<Column<'_, Row>> {
        let kernel = self.rows.iter().any(|row: &Row| row.kernel.is_some());
        let cost = self.rows.iter().any(|row: &Row| row.cost.is_some());
        let mut columns: Vec<Column<'_, Row>> = vec![
            left("scene", |row: &Row| row.task.scene.clone()),
            left("rays", |row: &Row| row.task.rays.to_string()),
            left("layout", |row: &Row| row.layout.clone()),
            left("tree", |row: &Row| row.tree.to_string()),
            right("Mrays/s", |row: &Row| spread(&row.speed)),
            right("hits", |row: &Row| format!("{:.1} %", 100.0 * row.hit_share)),
            right("nodes", |row: &Row| messages::bytes(row.node_bytes as u64)),
            right("triangles", |row: &Row| messages::bytes(row.triangle_bytes as u64)),
        ];
        if kernel {
            let of = |row: &Row, value: fn(&raywarp::device::KernelInfo) -> String| {
                row.kernel.as_ref().map_or("-".to_owned(), value)
            };
            columns.push(right("registers", move |row: &Row| of(row, |kernel| kernel.registers.to_string())));
            columns.push(right("local bytes", move |row: &Row| of(row, |kernel| kernel.local_bytes.to_string())));
            columns.push(right("occupancy", move |row: &Row| {
                of(row, |kernel| format!("{:.0} %", 100.0 * kernel.occupancy))
            }));
        }
        if cost {
            columns.push(right("nodes a ray", |row: &Row| {
                row.cost.map_or("-".into(), |c| format!("{:.1}", c.nodes_per_ray))
            }));
            let triangles = |row: &Row| row.cost.map_or("-".into(), |c| format!("{:.1}", c.triangles_per_ray));
            columns.push(right("triangles a ray", triangles));
        }
        columns
    }

    fn peer_columns(&self) -> Vec<Column<'_, PeerRow>> {
        vec![
            left("scene", |row: &PeerRow| row.task.scene.clone()),
            left("rays", |row: &PeerRow| row.task.rays.to_string()),
            left("peer", |row: &PeerRow| format!("{} ({}), {}", row.peer.name, row.peer.version, row.variant)),
            left("on", |row: &PeerRow| row.peer.device.clone()),
            right("Mrays/s", |row: &PeerRow| spread(&row.speed)),
            right("raywarp's best over it", |row: &PeerRow| format!("{:.2}", self.best(row) / row.speed.mrays_per_s)),
            right("hit or miss differs", |row: &PeerRow| row.agreement.hit_or_miss.to_string()),
            right("t differs by over 0.1 %", |row: &PeerRow| closest(row, row.agreement.distance.to_string())),
            right("by at most", |row: &PeerRow| closest(row, format!("{:.1e}", row.agreement.largest))),
        ]
    }

    /// Raywarp's highest rate for the rays of a peer's row.
    fn best(&self, peer: &PeerRow) -> f64 {
        let same = |row: &&Row| row.task.scene == peer.task.scene && row.task.rays == peer.task.rays;
        self.rows.iter().filter(same).map(|row| row.speed.mrays_per_s).fold(0.0, f64::max)
    }
}

/// A filled table as it is printed.
pub(super) fn table<R>(columns: &[Column<R>], rows: &[R]) -> String {
    Table::of(columns, rows).markdown(str::to_owned)
}

/// Where any hit will do, nobody has a distance.
fn closest(row: &PeerRow, text: String) -> String {
    if row.task.any_hit {
        "-".to_owned()
    } else {
        text
    }
}

fn spread(speed: &Speed) -> String {
    let [median, least, most] = [speed.mrays_per_s, speed.mrays_per_s_least, speed.mrays_per_s_most].map(number);
    format!("{median} ({least} to {most})")
}

/// Three digits or more.
pub(super) fn number(value: f64) -> String {
    let digits = if value >= 100.0 {
        0
    } else if value >= 10.0 {
        1
    } else {
        2
    };
    format!("{value:.digits$}")
}
