//! Faults as the compiler reports them: a package of its own, for a case is compiled with all that its package needs.
