/// A text with every effect of the language, one a kind of force: `$then` is given the common statements, then each effect by name. A law that
/// vanishes with its coefficients has them among the parameters.
macro_rules! every_effect {
    ($then:ident) => {
        $then! {
            [
                param mass: kg = 2;
                param inertia: kg*m^2 = 0.3;
                coord p: [m; 2] = [0.1, 0.29];
                coord phi: rad = 0.1;
                coord a: [rad; 2] = 0;
                body wheel { mass: mass, com: p, inertia: inertia, angle: phi }
                gravity weight { acceleration: [0, -9.81] }
                for i in 0..2 { body disc { mass: mass, com: [0, 0], inertia: 0.02, angle: a[i] } }
                out height: m = p[1];
                out turning: rad/s = der(phi);
            ]
            constant { param tau: N*m = 2; torque constant: tau on a[0]; }
            spring {
                param k: N/m = 400;
                param c: N*s/m = 3;
                tsda coil { from: [0, 1m], to: p, stiffness: k, length: 0.6, damping: c }
            }
            bar {
                param G: Pa = 80e9;
                param loss: N*m*s = 0.01;
                rsda bar { angle: a[0] - a[1], stiffness: G*(PI*(6mm)^4/32)/0.4m, damping: loss }
            }
            drag { param cw: N*s^2/m^2 = 0.8; force drag: -cw*der(p)*norm(der(p)) on p; }
            gas {
                param filling: N = 150;
                param n: 1 = 1.4;
                force gas: -filling*(1m/(1m - p[0]))^n on p[0];
            }
            motor {
                input u: V;
                param km: N*m/A = 0.05;
                state current: A = 0.1;
                der(current) == (u - 1.2 [V/A]*current - 0.05 [V*s]*der(phi))/3 [V*s/A];
                torque motor: km*current on phi;
            }
            limited {
                param stall: N*m = 5;
                param most: N*m = 2;
                torque limited: min(max(stall*(1 - der(a[0])/300 [rad/s]), -most), most) on a[0];
            }
            bushing {
                param stiff: N/m = 4000;
                param soft: N/m = 900;
                param loss_along: N*s/m = 12;
                let w = [dot(p, unit(30deg)), dot(p, unit(120deg))];
                force bush: [-stiff*w[0] - loss_along*der(w[0]), -soft*w[1]] on w;
            }
            backlash {
                param play: m = 0.2mm;
                param teeth_stiffness: N/m = 1e6;
                let s = 30mm*a[0] - 60mm*a[1];
                force teeth: -teeth_stiffness*(max(s - play/2, 0) + min(s + play/2, 0)) on s;
            }
            smooth {
                param mu: 1 = 0.2;
                param oil: N*s/m = 1;
                friction smooth { along: 0.3m*a[0], normal: 5N, coefficient: mu, speed: 1mm/1s, viscous: oil }
            }
            sticking {
                param mu_sliding: 1 = 0.2;
                param mu_sticking: 1 = 0.3;
                friction sticking { along: 0.3m*a[1], normal: 5N, coefficient: mu_sliding, sticks: mu_sticking, speed: 0.1 }
            }
            bristles {
                param rough_normal: N = 5;
                friction rough {
                    along: p[0], normal: rough_normal, coefficient: 0.2, sticks: 0.3, speed: 0.1, bristles: 50um, damping: 10
                }
            }
            stop {
                param stop_stiffness: N/m = 1e5;
                contact stop { gap: 0.5m - p[0], stiffness: stop_stiffness, exponent: 1.5, depth: 1mm, restitution: 0.6, approach: 0.5 }
            }
            tyre {
                param carcass: N/m = 2e5;
                state v: m = 0;
                let slides = 0.3m*der(phi) - der(p[0]);
                der(v) == slides - abs(der(p[0]))*v/0.4m;
                contact road { gap: p[1] - 0.3m, stiffness: carcass, damping: 0.5 }
                force tread: normal(road)*0.95*sin(1.65*atan(10*v/0.4m)) on p[0] - 0.3m*phi;
            }
            turntable {
                param Omega: rad/s = 3;
                potential field = -mass*Omega^2*dot(p, p)/2;
                force coriolis: 2*mass*Omega*[der(p[1]), -der(p[0])] on p;
            }
            landing {
                param deck: m = 2;
                contact landing { gap: deck + p[1], restitution: 0.6 }
                friction scrape { along: p[0], normal: normal(landing), coefficient: 0.2, sticks: 0.3 }
            }
            cradle { contact knock { gap: 1m*(2 + a[0] - a[1]), restitution: 0.9, simultaneous: ordered } }
            switched {
                param lift: N = 40;
                event low: p[1] < 0.28m until p[1] > 0.5m;
                latch since: s = t at low;
                force boost: lift*low on p[1];
                out lasted: s = t - since;
            }
            clearance {
                param shell: N/m = 1e6;
                let off = p - [0.1m, 0.1m];
                contact journal { gap: 0.19m - norm(off), stiffness: shell, exponent: 1.5, depth: 1mm, damping: 0.3 }
            }
            cam {
                param pad: N/m = 1e5;
                function pitch: m(rad), C3, periodic TAU;
                curve lobe = polar pitch about [0.1m, 0.1m] turned a[0];
                contact follower { gap: distance(p, lobe), stiffness: pad, damping: 0.2 }
            }
            table { param share: 1 = 0.5; function load: N(m), C1; force pressed: share*load(p[0]) on p[0]; }
            wave { param swell: N = 3; force wave: swell*sin(7 [rad/s]*t) on p[1]; }
        }
    };
}
