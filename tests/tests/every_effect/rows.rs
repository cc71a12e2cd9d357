/// Effects that add coordinates and rows, beside those of `every_effect`: a foot within a reach, and rows that follow from others within a width.
macro_rules! every_row {
    ($then:ident) => {
        $then! {
            []
            face {
                param clearance: m = 1;
                param face_stiffness: N/m = 1e5;
                function outline: m(rad), C3, periodic TAU;
                curve plate = polar outline about [1m, 0.1m] turned a[1];
                foot heel of p on plate within clearance near 180deg;
                contact sole { gap: heel_gap, stiffness: face_stiffness, damping: 0.2 }
            }
            guide {
                coord pin: [m; 2] = [0.2, 0.58];
                constraint pinned { pin == 2*p; }
                constraint measured redundant within 1um { pin[0] == 2*p[0]; }
            }
        }
    };
}
