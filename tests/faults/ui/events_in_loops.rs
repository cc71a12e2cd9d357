#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    mechanism Balls;
    const N: 1 = 2;
    coord y: [m; 3] = [1, 2, 3];
    let n = 3;
    for i in 0..3 { body balls { mass: 1kg, com: [0, y[i]] } }
    for i in 0..3 {
        event low[i]: y[i] < 0;
        latch since[i]: s = t at low[i];
    }
    for i in 0..3 {
        event high: y[i] > 1m;
        latch first: s = t at high;
        latch second: [m; i] = y[i] at high[i];
        latch third: m = y[i] at hihg[i];
        latch fourth: m = y[i] at high[i + 1];
        force push: -10N*high on y[i];
        torque turn: 1 [N*m]*high[i + 1] on y[i]/1m;
    }
    for i in 0..n { event far: y[i] > 5m; }
    for i in 0..N { let k = i + 1; for j in 0..k { event near: y[j] > i*1m; } }
    for i in 0..6001 { event many: y[0] > i*1mm; }
    for i in 0..3 { event same: y[i] > i*1m; }
    for i in 0..2 { event same: y[i] < i*1m; }
    event one: y[0] > 3m;
    latch fifth: m = y[0] at one[0];
    latch sixth: s = t at high[3];
    latch seventh: s = t at fifth;
    out all: 1 = high;
    constraint held { y[0] == 1m*high[0]; }
    force back: -10N*far[0]*near[0]*low[0]*since[0]/1s*many[0] on y[0];
}

fn main() {}
