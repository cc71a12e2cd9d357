//! Events, contacts and limits within a step.
