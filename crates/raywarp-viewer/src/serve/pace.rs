//! How many pictures are on their way to a client.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Most of them at a time: one is made while the other travels.
const IN_FLIGHT: usize = 2;

/// Pictures from the moment they are begun until the client shows them.
#[derive(Debug, Default)]
pub struct Pace {
    flights: VecDeque<Flight>,
}

#[derive(Debug)]
struct Flight {
    frame: u32,
    lossless: bool,
    sent: Option<Instant>,
    bytes: u64,
    received: u64,
    /// Whether all of it is known to have arrived.
    landed: bool,
}

/// A picture that has arrived: what the link took, and nothing of what the page does with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Delivery {
    /// From its first byte sent to the answer to the ping behind its last one.
    pub time: Duration,
    /// Of it.
    pub bytes: u64,
    /// Whether it was sent in portions, so that its time means little.
    pub lossless: bool,
}

/// A picture that is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Acknowledged {
    /// From its first byte sent to the acknowledgement.
    pub time: Duration,
    /// Its delivery, where no pong has told of it before.
    pub delivery: Option<Delivery>,
}

impl Pace {
    /// Whether there may be one more; to a client whose pictures come late, only one at all.
    pub fn is_ready(&self, late: bool) -> bool {
        self.flights.len() < if late { 1 } else { IN_FLIGHT }
    }

    pub fn is_idle(&self) -> bool {
        self.flights.is_empty()
    }

    pub fn depart(&mut self, frame: u32, lossless: bool) {
        self.flights.push_back(Flight { frame, lossless, sent: None, bytes: 0, received: 0, landed: false });
    }

    pub fn sent(&mut self, frame: u32, bytes: usize) {
        if let Some(flight) = self.find(frame) {
            (flight.sent, flight.bytes) = (Some(Instant::now()), bytes as u64);
        }
    }

    pub fn received(&mut self, frame: u32, bytes: u64) {
        if let Some(flight) = self.find(frame) {
            flight.received = flight.received.max(bytes);
        }
    }

    /// Bytes of a picture that the client has.
    pub fn arrived(&self, frame: u32) -> u64 {
        self.flights.iter().find(|flight| flight.frame == frame).map_or(u64::MAX, |flight| flight.received)
    }

    pub fn abandon(&mut self, frame: u32) {
        self.flights.retain(|flight| flight.frame != frame);
    }

    /// All of this picture has arrived. None where that is known, or it is not on its way: clients can say anything.
    pub fn landed(&mut self, frame: u32) -> Option<Delivery> {
        let flight = self.find(frame).filter(|flight| !flight.landed)?;
        let time = flight.sent?.elapsed();
        flight.landed = true;
        Some(Delivery { time, bytes: flight.bytes, lossless: flight.lossless })
    }

    /// This picture and all before it are shown. None where it is not on its way, or has not even been sent.
    pub fn acknowledge(&mut self, frame: u32) -> Option<Acknowledged> {
        let time = self.find(frame)?.sent?.elapsed();
        let delivery = self.landed(frame);
        self.flights.retain(|flight| flight.frame > frame);
        Some(Acknowledged { time, delivery })
    }

    fn find(&mut self, frame: u32) -> Option<&mut Flight> {
        self.flights.iter_mut().find(|flight| flight.frame == frame)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_travel_and_the_third_waits() {
        let mut pace = Pace::default();
        assert!(pace.is_idle() && pace.is_ready(false));
        pace.depart(1, false);
        pace.depart(2, true);
        assert!(!pace.is_ready(false));
        assert_eq!(pace.acknowledge(1), None, "not sent yet");
        assert_eq!(pace.acknowledge(7), None, "never begun");
        pace.sent(1, 100);
        assert_eq!(pace.acknowledge(1).and_then(|shown| shown.delivery).map(|delivery| delivery.bytes), Some(100));
        assert!(pace.is_ready(false) && !pace.is_ready(true) && !pace.is_idle());
        pace.abandon(2);
        assert!(pace.is_idle());
    }

    #[test]
    fn a_later_picture_stands_for_those_before_it() {
        let mut pace = Pace::default();
        pace.depart(1, false);
        pace.depart(2, false);
        pace.sent(2, 1);
        assert!(pace.acknowledge(2).is_some() && pace.is_idle());
    }

    #[test]
    fn a_delivery_ends_with_the_pong_and_is_told_once() {
        let mut pace = Pace::default();
        pace.depart(3, false);
        assert_eq!(pace.landed(3), None, "not sent yet");
        pace.sent(3, 50);
        assert_eq!(pace.landed(3).map(|delivery| delivery.bytes), Some(50));
        assert_eq!(pace.landed(3), None);
        std::thread::sleep(Duration::from_millis(20));
        let shown = pace.acknowledge(3).unwrap();
        assert!(shown.delivery.is_none() && shown.time >= Duration::from_millis(20), "{shown:?}");
        assert_eq!(pace.landed(3), None);
    }

    #[test]
    fn what_has_arrived_only_grows() {
        let mut pace = Pace::default();
        pace.depart(5, true);
        pace.received(5, 100);
        pace.received(5, 40);
        pace.received(6, 1000);
        assert_eq!((pace.arrived(5), pace.arrived(6)), (100, u64::MAX));
    }
}
