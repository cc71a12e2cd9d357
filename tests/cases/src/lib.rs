//! Faults that were found, one file for each, named by its entry: the text with the fault and tests of its class.
