//! Shared ground of the workspace-wide tests.
