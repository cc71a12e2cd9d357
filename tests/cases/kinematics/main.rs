//! Positions, velocities and accelerations: assemblies kept, accuracy near singular positions, refusals.
mod k6_declared_branch_near_a_change_point;
