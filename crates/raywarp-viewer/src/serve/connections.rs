//! Connections that have not shown the token: a bounded number, of which the least recently active makes room.
//!
//! Nobody waits at the door. A connection beyond the limit closes the one that has been idle longest, among those of the
//! address that holds most; who has shown the token is in no table and is not closed.

use std::collections::{BTreeMap, HashMap};
use std::net::IpAddr;
use std::sync::{Arc, Mutex};

use tokio::sync::watch;

use super::registry::lock;

/// All of them.
#[derive(Debug)]
pub struct Connections {
    table: Mutex<Table>,
    most: usize,
}

#[derive(Debug, Default)]
struct Table {
    /// Counts what happens: a clock that never says the same twice.
    clock: u64,
    open: BTreeMap<u64, Entry>,
}

#[derive(Debug)]
struct Entry {
    from: IpAddr,
    active: u64,
    evicted: watch::Sender<bool>,
}

impl Connections {
    /// At most so many, at least 1.
    pub fn new(most: usize) -> Arc<Self> {
        Arc::new(Self { table: Mutex::default(), most: most.max(1) })
    }

    /// Enters a connection; where there is no room, another is evicted.
    pub fn enter(self: &Arc<Self>, from: IpAddr) -> Connection {
        let mut table = lock(&self.table);
        while table.open.len() >= self.most {
            table.evict();
        }
        let id = table.tick();
        let (evicted, eviction) = watch::channel(false);
        table.open.insert(id, Entry { from: network(from), active: id, evicted });
        Connection { id, eviction, among: Arc::clone(self) }
    }

    /// Closes one, as the system has no room for more.
    pub fn evict(&self) {
        lock(&self.table).evict();
    }

    #[cfg(test)]
    fn len(&self) -> usize {
        lock(&self.table).open.len()
    }
}

impl Table {
    fn tick(&mut self) -> u64 {
        self.clock += 1;
        self.clock
    }

    fn evict(&mut self) {
        let mut held: HashMap<IpAddr, usize> = HashMap::new();
        self.open.values().for_each(|entry| *held.entry(entry.from).or_default() += 1);
        let rank = |entry: &Entry| (std::cmp::Reverse(held.get(&entry.from).copied()), entry.active);
        let chosen = self.open.iter().min_by_key(|(_, entry)| rank(entry)).map(|(&id, _)| id);
        if let Some(entry) = chosen.and_then(|id| self.open.remove(&id)) {
            entry.evicted.send_replace(true);
        }
    }
}

/// What counts as one address: a host has many of IPv6, and all of one network.
fn network(ip: IpAddr) -> IpAddr {
    match ip.to_canonical() {
        IpAddr::V6(ip) => IpAddr::V6((u128::from(ip) & !u128::from(u64::MAX)).into()),
        v4 => v4,
    }
}

/// One of them. It leaves the table when this is dropped: closed, or with the token shown.
#[derive(Debug)]
pub struct Connection {
    id: u64,
    eviction: watch::Receiver<bool>,
    among: Arc<Connections>,
}

impl Connection {
    /// It has asked for something.
    pub fn touch(&self) {
        let table = &mut *lock(&self.among.table);
        let now = table.tick();
        if let Some(entry) = table.open.get_mut(&self.id) {
            entry.active = now;
        }
    }

    /// Waits until it has to make room.
    pub async fn evicted(&self) {
        let mut eviction = self.eviction.clone();
        // Without its sender it is out of the table, which is the same.
        let _ = eviction.wait_for(|&evicted| evicted).await;
    }
}

impl Drop for Connection {
    fn drop(&mut self) {
        lock(&self.among.table).open.remove(&self.id);
    }
}

#[cfg(test)]
mod tests {
    use std::net::{Ipv4Addr, Ipv6Addr};

    use super::*;

    const HERE: IpAddr = IpAddr::V4(Ipv4Addr::LOCALHOST);

    fn there(last: u8) -> IpAddr {
        IpAddr::V4(Ipv4Addr::new(192, 0, 2, last))
    }

    fn is_evicted(connection: &Connection) -> bool {
        *connection.eviction.borrow()
    }

    #[test]
    fn the_least_recently_active_makes_room() {
        let connections = Connections::new(3);
        let [a, b, c] = [(); 3].map(|()| connections.enter(HERE));
        a.touch();
        let d = connections.enter(HERE);
        assert_eq!([&a, &b, &c, &d].map(is_evicted), [false, true, false, false]);
        assert_eq!(connections.len(), 3);
        drop((a, d));
        let _e = connections.enter(HERE);
        assert!(!is_evicted(&c), "two have left");
    }

    #[test]
    fn the_address_that_holds_most_makes_room() {
        let connections = Connections::new(4);
        let quiet = connections.enter(there(1));
        let crowd = [(); 3].map(|()| connections.enter(there(2)));
        let _more = [3, 4].map(|last| connections.enter(there(last)));
        assert!(!is_evicted(&quiet), "it has been idle for longest, and is alone");
        assert_eq!(crowd.each_ref().map(is_evicted), [true, true, false]);
    }

    #[test]
    fn a_network_of_ipv6_is_one_address() {
        let of = |text: &str| network(text.parse::<Ipv6Addr>().unwrap().into());
        assert_eq!(of("2001:db8::1"), of("2001:db8::ffff:2"));
        assert_ne!(of("2001:db8::1"), of("2001:db8:0:1::1"));
        assert_eq!(of("::ffff:192.0.2.1"), there(1));
    }
}
