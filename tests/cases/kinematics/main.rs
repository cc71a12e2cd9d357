//! Positions, velocities and accelerations: assemblies kept, accuracy near singular positions, refusals.
