//! Ready mechanisms.
