//! What was changed, step by step, so that it can be taken back.

use std::collections::{BTreeMap, VecDeque};
use std::time::{Duration, Instant};

use super::field::Field;
use crate::live::Value;

/// Steps that are kept.
const MOST_STEPS: usize = 256;
/// Changes of one value that follow each other this fast are one step: the drag of a slider.
const SAME_STEP: Duration = Duration::from_millis(800);

/// Whether a change is one step with the change of the same field before it.
#[derive(Clone, Copy, Debug)]
pub(super) enum Join {
    /// If that was shortly before this time.
    Soon(Instant),
    /// In any case: the same drag.
    Always,
    Never,
}

/// Values that differ from those of the files.
pub(super) type Changes = BTreeMap<Field, Value>;

/// What a step made of some fields: the values before and after, none where they are as the files say.
type Step = Vec<(Field, [Option<Value>; 2])>;

/// A step and its number, which no other step ever has.
type Numbered = (u64, Step);

/// The values that differ, and how they came to.
#[derive(Clone, Debug, Default)]
pub(super) struct History {
    changes: Changes,
    done: VecDeque<Numbered>,
    undone: Vec<Numbered>,
    /// Steps so far, those that were forgotten included.
    steps: u64,
    last: Option<Instant>,
}

impl History {
    pub fn changes(&self) -> &Changes {
        &self.changes
    }

    pub fn can_undo(&self) -> bool {
        !self.done.is_empty()
    }

    pub fn can_redo(&self) -> bool {
        !self.undone.is_empty()
    }

    /// Number of the step that would be taken back, 0 for none.
    pub fn last_step(&self) -> u64 {
        self.done.back().map_or(0, |step| step.0)
    }

    /// Number of the step that would be done again.
    pub fn next_step(&self) -> Option<u64> {
        self.undone.last().map(|step| step.0)
    }

    /// Gives fields their values, none for those of the files; returns the fields that are others now.
    pub fn set(&mut self, wanted: Vec<(Field, Option<Value>)>, join: Join) -> Vec<Field> {
        let step: Step = wanted
            .into_iter()
            .map(|(field, after)| (field, [self.changes.get(&field).cloned(), after]))
            .filter(|(_, [before, after])| before != after)
            .collect();
        if step.is_empty() {
            return Vec::new();
        }
        let touched = self.apply(&step, 1);
        self.undone.clear();
        let joins = match join {
            Join::Soon(now) => self.last.is_some_and(|last| now.saturating_duration_since(last) < SAME_STEP),
            Join::Always => true,
            Join::Never => false,
        };
        self.last = if let Join::Soon(now) = join { Some(now) } else { None };
        match (self.done.back_mut().map(|step| step.1.as_mut_slice()), step.as_slice()) {
            (Some([(field, [_, after])]), [(same, [_, value])]) if joins && field == same => *after = value.clone(),
            _ => {
                self.steps += 1;
                self.done.push_back((self.steps, step));
            }
        }
        if self.done.len() > MOST_STEPS {
            self.done.pop_front();
        }
        touched
    }

    /// Takes the last step back; returns the fields that are others now.
    pub fn undo(&mut self) -> Vec<Field> {
        let Some(step) = self.done.pop_back() else { return Vec::new() };
        let touched = self.apply(&step.1, 0);
        self.undone.push(step);
        self.last = None;
        touched
    }

    /// Does the last step that was taken back again.
    pub fn redo(&mut self) -> Vec<Field> {
        let Some(step) = self.undone.pop() else { return Vec::new() };
        let touched = self.apply(&step.1, 1);
        self.done.push_back(step);
        self.last = None;
        touched
    }

    /// Keeps only the values of some fields, and forgets all steps.
    pub fn retain(&mut self, keep: impl Fn(&Field) -> bool) {
        let mut changes = std::mem::take(&mut self.changes);
        changes.retain(|field, _| keep(field));
        *self = Self { changes, steps: self.steps, ..Self::default() };
    }

    fn apply(&mut self, step: &Step, side: usize) -> Vec<Field> {
        for (field, values) in step {
            match values[side].clone() {
                Some(value) => self.changes.insert(*field, value),
                None => self.changes.remove(field),
            };
        }
        step.iter().map(|(field, _)| *field).collect()
    }
}
