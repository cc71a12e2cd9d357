//! Faults that were found, one file a fault, named by its entry: the text that showed it and tests of its class.
