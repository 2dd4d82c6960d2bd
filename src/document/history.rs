//! Undo without limit: whole [`Edits`] values, shared by `Arc`; undo and redo choose another one.
//!
//! There are no inverse operations to get wrong. Steps of one held key join into one; what is drawn and from where
//! is not history, so it stays as it is when another revision is chosen, unless the step between them was to reset it. A new edit after undo forgets what was
//! undone. Revisions are never dropped; one costs a few hundred bytes.

use std::sync::Arc;

use super::Edits;

/// Every value the edits have had, and which one is in use.
#[derive(Clone, Debug)]
pub struct History {
    /// Invariant: never empty.
    revisions: Vec<Revision>,
    /// Index into `revisions`.
    at: usize,
}

#[derive(Clone, Debug)]
struct Revision {
    edits: Arc<Edits>,
    /// The step that made it is one of what is drawn and from where, too.
    of_view: bool,
    /// What that step was, for people; empty for the first.
    what: String,
}

impl History {
    /// Begins with these edits.
    pub fn new(edits: Edits) -> Self {
        Self { revisions: vec![Revision { edits: Arc::new(edits), of_view: false, what: String::new() }], at: 0 }
    }

    /// Returns the edits in use.
    pub fn edits(&self) -> &Arc<Edits> {
        &self.revisions[self.at].edits
    }

    /// Takes new edits into use, made by a step that is `what` for people. With `joins` they replace the present revision in place of following it.
    ///
    /// Edits that differ only in what is drawn replace it always; equal edits change nothing.
    pub fn push(&mut self, edits: Edits, joins: bool, what: String) {
        if edits == **self.edits() {
            return;
        }
        let unrecorded = edits == Edits { view: edits.view.clone(), ..(**self.edits()).clone() };
        let edits = Arc::new(edits);
        if unrecorded {
            self.revisions[self.at].edits = edits;
            return;
        }
        self.revisions.truncate(self.at + 1);
        if joins && self.at > 0 {
            let revision = &mut self.revisions[self.at];
            (revision.edits, revision.what) = (edits, what);
        } else {
            self.follow_by(Revision { edits, of_view: false, what });
        }
    }

    /// Takes new edits into use in a step that can be undone although it may change only what is drawn.
    pub fn push_view(&mut self, edits: Edits, what: String) {
        if edits != **self.edits() {
            self.follow_by(Revision { edits: Arc::new(edits), of_view: true, what });
        }
    }

    fn follow_by(&mut self, revision: Revision) {
        self.revisions.truncate(self.at + 1);
        self.revisions.push(revision);
        self.at += 1;
    }

    /// Goes back one revision; false at the first.
    pub fn undo(&mut self) -> bool {
        self.at > 0 && self.choose(self.at - 1)
    }

    /// Goes forward one revision; false at the last.
    pub fn redo(&mut self) -> bool {
        self.at + 1 < self.revisions.len() && self.choose(self.at + 1)
    }

    /// Returns what the step was that undo takes back; none at the first revision.
    pub fn undoable(&self) -> Option<&str> {
        (self.at > 0).then(|| self.revisions[self.at].what.as_str())
    }

    /// Returns what the step was that redo makes again; none at the last revision.
    pub fn redoable(&self) -> Option<&str> {
        self.revisions.get(self.at + 1).map(|revision| revision.what.as_str())
    }

    /// Returns how many steps can be undone and redone.
    pub fn depth(&self) -> (usize, usize) {
        (self.at, self.revisions.len() - 1 - self.at)
    }

    fn choose(&mut self, at: usize) -> bool {
        let view = self.edits().view.clone();
        let of_view = self.revisions[self.at.max(at)].of_view;
        self.at = at;
        if !of_view && self.edits().view != view {
            self.revisions[at].edits = Arc::new(Edits { view, ..(**self.edits()).clone() });
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_nudge(nudge: f64) -> Edits {
        let mut edits = Edits::default();
        edits.path.nudge = nudge;
        edits
    }

    #[test]
    fn undo_and_redo_walk_the_revisions() {
        let mut history = History::new(Edits::default());
        history.push(with_nudge(1.0), false, "a step".to_owned());
        history.push(with_nudge(2.0), false, "a step".to_owned());
        assert!(history.undo());
        assert_eq!(history.edits().path.nudge, 1.0);
        assert!(history.undo());
        assert!(!history.undo());
        assert_eq!((history.undoable(), history.redoable()), (None, Some("a step")));
        assert!(history.redo() && history.redo());
        assert_eq!((history.undoable(), history.redoable()), (Some("a step"), None));
        assert!(!history.redo());
        assert_eq!(history.edits().path.nudge, 2.0);
    }

    #[test]
    fn joined_steps_are_undone_at_once() {
        let mut history = History::new(Edits::default());
        history.push(with_nudge(1.0), false, "a step".to_owned());
        history.push(with_nudge(2.0), true, "a step".to_owned());
        history.push(with_nudge(3.0), true, "a step".to_owned());
        assert_eq!(history.depth(), (1, 0));
        assert!(history.undo());
        assert_eq!(**history.edits(), Edits::default());
    }

    #[test]
    fn a_new_edit_forgets_what_was_undone() {
        let mut history = History::new(Edits::default());
        history.push(with_nudge(1.0), false, "a step".to_owned());
        history.undo();
        history.push(with_nudge(5.0), false, "a step".to_owned());
        assert!(!history.redo());
        assert_eq!(history.depth(), (1, 0));
    }

    #[test]
    fn what_is_drawn_is_not_history() {
        let mut history = History::new(Edits::default());
        history.push(with_nudge(1.0), false, "a step".to_owned());
        let mut hidden = (**history.edits()).clone();
        hidden.view.show.ground = false;
        history.push(hidden, false, "a step".to_owned());
        assert_eq!(history.depth(), (1, 0));
        history.undo();
        assert!(!history.edits().view.show.ground);
    }

    #[test]
    fn a_step_of_what_is_drawn_is_undone_with_what_was_drawn_before_it() {
        let mut hidden = with_nudge(1.0);
        hidden.view.show.ground = false;
        let mut history = History::new(hidden.clone());
        history.push(Edits { view: hidden.view.clone(), ..with_nudge(2.0) }, false, "a step".to_owned());
        history.push_view(with_nudge(2.0), "the view".to_owned());
        assert_eq!((history.edits().view.show.ground, history.depth()), (true, (2, 0)));
        history.push_view(with_nudge(2.0), "the view".to_owned());
        assert_eq!(history.depth(), (2, 0), "equal edits change nothing");
        assert!(history.undo());
        assert!(!history.edits().view.show.ground);
        assert!(history.redo());
        assert!(history.edits().view.show.ground);
        assert!(history.undo() && history.undo());
        assert!(!history.edits().view.show.ground, "other steps leave it alone");
    }
}
