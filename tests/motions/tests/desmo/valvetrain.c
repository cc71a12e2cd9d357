/* Rigid desmodromic valvetrain, typed by hand in C. It shares no code with the library.
 *
 * Gap of a pad and its cam: (r - R)/sqrt(1 + (R'/r)^2), the distance of first order, with its whole gradient.
 * Coordinates: opener (rad), closer (rad), lift (m) and their rates; the cam's angle is -pi + speed t.
 *
 *   cc -O3 -o valvetrain tests/motions/tests/desmo/valvetrain.c -lm
 *   ./valvetrain reference > tests/motions/data/desmo.csv
 *   ./valvetrain turn METHOD TOLERANCE PLAY ROUNDS     METHOD: rk4 (TOLERANCE: steps a leg), dp5, dp8; PLAY: 0 or 1
 *
 * `turn` prints the lift at 72 places of one turn at 9000/min, then the processor time (ns) of each round. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define PI 3.14159265358979323846
#define KNOTS 720 /* of a cam's table */
#define LEGS 72
/* Instants at which peaks are looked for: an impact takes 10 to 50 µs, a turn 7 to 12 ms. */
#define CASE_SAMPLES (500 * LEGS)
#define RUN_SAMPLES 28800

static const double CENTRE[2] = {0.012, 0.020}; /* of both cams (m) */
static const double HALF = 80.0 * PI / 180.0;   /* half the duration of the lift (rad) */
static const double LIFT = 0.011;               /* (m) */

typedef struct {
    double pivot[2], cam[2], valve[2]; /* at lift 0: place of the pivot, arms to both pads (m) */
    double (*table)[6];                /* polar radius of the pitch curve, or NULL for its closed form */
} Rocker;

typedef struct {
    Rocker opener, closer;
    double speed, play[2], guide[2], stiffness, damping;
} Train;

/* Lift and two derivatives over the cam angle. */
static void law(double theta, double s[3]) {
    static const double c[5] = {-3, 10, -15, 9, -2};
    static const int p[5] = {2, 6, 8, 10, 12};
    double x = remainder(theta, 2 * PI) / HALF;
    s[0] = s[1] = s[2] = 0;
    if (fabs(x) >= 1) return;
    s[0] = 1;
    for (int k = 0; k < 5; k++) {
        double low = pow(x, p[k] - 2);
        s[0] += c[k] * low * x * x;
        s[1] += c[k] * p[k] * low * x;
        s[2] += c[k] * p[k] * (p[k] - 1) * low;
    }
    s[0] *= LIFT;
    s[1] *= LIFT / HALF;
    s[2] *= LIFT / (HALF * HALF);
}

/* Pitch curve z = e^(-i theta) (P - C + r e^(i(psi + alpha))) and two derivatives over theta. */
static void pitch(const Rocker *rocker, double theta, double z[3][2]) {
    double s[3], bx = rocker->valve[0], by = rocker->valve[1];
    law(theta, s);
    double length = hypot(bx, by), at = PI - asin((by - s[0]) / length), slope = length * cos(at);
    double psi = remainder(at - atan2(by, bx), 2 * PI);
    double psi1 = -s[1] / slope, psi2 = (-s[2] + length * sin(at) * psi1 * psi1) / slope;
    double si = sin(psi), co = cos(psi);
    double ax = co * rocker->cam[0] - si * rocker->cam[1], ay = si * rocker->cam[0] + co * rocker->cam[1];
    double w[3][2] = {{rocker->pivot[0] - CENTRE[0] + ax, rocker->pivot[1] - CENTRE[1] + ay},
                      {-psi1 * ay, psi1 * ax},
                      {-psi2 * ay - psi1 * psi1 * ax, psi2 * ax - psi1 * psi1 * ay}};
    double v[3][2] = {{w[0][0], w[0][1]},
                      {w[1][0] + w[0][1], w[1][1] - w[0][0]},
                      {w[2][0] + 2 * w[1][1] - w[0][0], w[2][1] - 2 * w[1][0] - w[0][1]}};
    si = sin(-theta), co = cos(-theta);
    for (int k = 0; k < 3; k++) {
        z[k][0] = co * v[k][0] - si * v[k][1];
        z[k][1] = si * v[k][0] + co * v[k][1];
    }
}

/* Polar radius of the pitch curve and two derivatives over the polar angle, by Newton's method from theta. */
static void radius_exact(const Rocker *rocker, double angle, double theta, double out[3]) {
    double z[3][2], si = sin(angle), co = cos(angle);
    for (int k = 0; k < 30; k++) {
        pitch(rocker, theta, z);
        double left = atan2(co * z[0][1] - si * z[0][0], co * z[0][0] + si * z[0][1]);
        double step = left * (z[0][0] * z[0][0] + z[0][1] * z[0][1]) / (z[0][0] * z[1][1] - z[0][1] * z[1][0]);
        theta -= step;
        if (fabs(step) < 1e-15) break;
    }
    pitch(rocker, theta, z);
    double r = hypot(z[0][0], z[0][1]);
    double r1 = (z[0][0] * z[1][0] + z[0][1] * z[1][1]) / r;
    double r2 = (z[1][0] * z[1][0] + z[1][1] * z[1][1] + z[0][0] * z[2][0] + z[0][1] * z[2][1] - r1 * r1) / r;
    double w1 = (z[0][0] * z[1][1] - z[0][1] * z[1][0]) / (r * r);
    double w2 = (z[0][0] * z[2][1] - z[0][1] * z[2][0]) / (r * r) - 2 * r1 * w1 / r;
    out[0] = r;
    out[1] = r1 / w1;
    out[2] = (r2 * w1 - r1 * w2) / (w1 * w1 * w1);
}

/* Quintic polynomials between knots through value and two derivatives. */
static void tabulate(Rocker *rocker) {
    double(*table)[6] = malloc(KNOTS * sizeof *table), h = 2 * PI / KNOTS, theta = 0;
    static double knot[KNOTS + 1][3];
    for (int k = 0; k <= KNOTS; k++) {
        /* The polar angle of the pitch curve falls as theta grows: start near, then follow. */
        if (k == 0) {
            double z[3][2];
            pitch(rocker, 0, z);
            theta = atan2(z[0][1], z[0][0]);
        }
        double angle = k * h;
        radius_exact(rocker, angle, theta - angle, knot[k]);
    }
    for (int k = 0; k < KNOTS; k++) {
        double *a = knot[k], *b = knot[k + 1], *c = table[k];
        double d0 = b[0] - a[0] - a[1] * h - 0.5 * a[2] * h * h;
        double d1 = (b[1] - a[1] - a[2] * h) * h, d2 = (b[2] - a[2]) * h * h;
        c[0] = a[0];
        c[1] = a[1] * h;
        c[2] = 0.5 * a[2] * h * h;
        c[3] = 10 * d0 - 4 * d1 + 0.5 * d2;
        c[4] = -15 * d0 + 7 * d1 - d2;
        c[5] = 6 * d0 - 3 * d1 + 0.5 * d2;
    }
    rocker->table = table;
}

static inline void radius(const Rocker *rocker, double angle, double theta, double out[3]) {
    if (!rocker->table) {
        radius_exact(rocker, angle, theta, out);
        return;
    }
    const double per = KNOTS / (2 * PI);
    double x = angle * per;
    x -= KNOTS * floor(x / KNOTS);
    int k = (int)x;
    if (k >= KNOTS) k = KNOTS - 1;
    const double *c = rocker->table[k];
    double u = x - k;
    out[0] = c[0] + u * (c[1] + u * (c[2] + u * (c[3] + u * (c[4] + u * c[5]))));
    out[1] = per * (c[1] + u * (2 * c[2] + u * (3 * c[3] + u * (4 * c[4] + u * 5 * c[5]))));
    out[2] = per * per * (2 * c[2] + u * (6 * c[3] + u * (12 * c[4] + u * 20 * c[5])));
}

/* Gap of a pad and its cam, its derivatives over the rocker's angle and the cam's. */
static inline void cam_gap(const Rocker *rocker, double si, double co, double theta, double g[3]) {
    double ax = co * rocker->cam[0] - si * rocker->cam[1], ay = si * rocker->cam[0] + co * rocker->cam[1];
    double x = rocker->pivot[0] - CENTRE[0] + ax, y = rocker->pivot[1] - CENTRE[1] + ay;
    double rr = x * x + y * y, r = sqrt(rr), R[3];
    radius(rocker, atan2(y, x) - theta, theta, R);
    double tilt = R[1] / r, root = 1 / sqrt(1 + tilt * tilt), beside = (r - R[0]) * tilt * root * root * root;
    double dr = (y * ax - x * ay) / r, dw = (x * ax + y * ay) / rr;
    g[0] = (r - R[0]) * root;
    g[1] = (dr - R[1] * dw) * root - beside * (R[2] * dw / r - R[1] * dr / rr);
    g[2] = R[1] * root + beside * R[2] / r;
}

static inline double normal(const Train *train, double gap, double rate) {
    if (gap >= 0) return 0;
    double damped = 1 - train->damping * rate;
    return damped > 0 ? train->stiffness * -gap * sqrt(-gap) * damped : 0;
}

/* Rates of the state; forces of nose, tip, seat, heel, fork (N). */
static inline void rates(const Train *train, double t, const double y[6], double f[6], double force[5]) {
    const Rocker *o = &train->opener, *c = &train->closer;
    double theta = -PI + train->speed * t, nose[3], heel[3];
    double si = sin(y[0]), co = cos(y[0]), sc = sin(y[1]), cc = cos(y[1]);
    cam_gap(o, si, co, theta, nose);
    cam_gap(c, sc, cc, theta, heel);
    double opened = o->valve[1] - si * o->valve[0] - co * o->valve[1];
    double opened_q = -co * o->valve[0] + si * o->valve[1];
    double closed = c->valve[1] - sc * c->valve[0] - cc * c->valve[1];
    double closed_q = -cc * c->valve[0] + sc * c->valve[1];
    force[0] = normal(train, nose[0], nose[1] * y[3] + nose[2] * train->speed);
    force[1] = normal(train, y[2] - opened + train->play[0], y[5] - opened_q * y[3]);
    force[2] = normal(train, y[2], y[5]);
    force[3] = normal(train, heel[0], heel[1] * y[4] + heel[2] * train->speed);
    force[4] = normal(train, closed - y[2] + train->play[1], closed_q * y[4] - y[5]);
    double friction = train->guide[0] * y[5];
    if (train->guide[1] != 0) friction += train->guide[1] * tanh(y[5] / 0.05);
    f[0] = y[3];
    f[1] = y[4];
    f[2] = y[5];
    f[3] = (force[0] * nose[1] - force[1] * opened_q) * (1 / 1.3e-5);
    f[4] = (force[3] * heel[1] + force[4] * closed_q - 1.2 - y[1]) * (1 / 2.2e-5);
    f[5] = (force[1] + force[2] - force[4] - friction) * (1 / 0.028) + 9.80665;
}

#include "steps.h"

static Train ready(double speed, double play, double guide) {
    Train train = {.opener = {{0.031, 0.001}, {-0.018, -0.00498}, {-0.031, 0.007}, NULL},
                   .closer = {{0.035, -0.009}, {0, 0}, {-0.035, -0.003}, NULL},
                   .speed = speed * PI / 30,
                   .play = {play * 1e-4, play * 3e-5},
                   .guide = {guide * 2, guide * 3},
                   .stiffness = 5e10,
                   .damping = 1.5};
    /* An arm of 29 mm to a pad that is 29 mm from the cams' centre, right of the line to it. */
    Rocker *c = &train.closer;
    double x = CENTRE[0] - c->pivot[0], y = CENTRE[1] - c->pivot[1];
    double angle = atan2(y, x) - acos(0.5 * hypot(x, y) / 0.029);
    c->cam[0] = 0.029 * cos(angle);
    c->cam[1] = 0.029 * sin(angle);
    return train;
}

/* Largest forces and magnitude of the valve's acceleration over a turn; the state goes on. */
static void peaks(const Train *train, Run *run, double until, int samples, double peak[6], double *lifts) {
    double from = run->t, f[6], force[5];
    memset(peak, 0, 6 * sizeof *peak);
    for (int k = 1; k <= samples; k++) {
        advance(train, run, from + (until - from) * k / samples);
        rates(train, run->t, run->y, f, force);
        peak[0] = fmax(peak[0], fabs(f[5]));
        for (int i = 0; i < 5; i++) peak[i + 1] = fmax(peak[i + 1], force[i]);
        if (lifts && k % (samples / LEGS) == 0) lifts[k / (samples / LEGS) - 1] = run->y[2];
    }
}

static void print_peaks(const double peak[6]) {
    for (int i = 0; i < 6; i++) printf(",%.9e", peak[i]);
    printf("\n");
}

static void reference(void) {
    struct { const char *name; double speed, play, guide, turns; } cases[] = {
        {"5000 fitted", 5000, 0, 0, 1}, {"9000 fitted", 9000, 0, 0, 1},
        /* To 20 degrees behind full lift: the valve is opened, and the closer has caught it. */
        {"9000 play", 9000, 1, 1, 200.0 / 360}, {"9000 turn", 9000, 1, 1, 1},
        {"9000 smooth", 9000, 1, 0, 1}};
    printf("# `cc -O3 -o valvetrain tests/motions/tests/desmo/valvetrain.c -lm && ./valvetrain reference` writes this file.\n");
    printf("# lift,case,72 lifts (m); peak,case and run,turn,factors of K, D and play: valve (m/s^2), nose, tip, seat, heel, fork (N)\n");
    for (int i = 0; i < 5; i++) {
        Train train = ready(cases[i].speed, cases[i].play, cases[i].guide);
        Run run = start(DP5, 3e-13);
        double peak[6], lifts[LEGS];
        peaks(&train, &run, cases[i].turns * 2 * PI / train.speed, CASE_SAMPLES, peak, lifts);
        printf("lift,%s", cases[i].name);
        for (int k = 0; k < LEGS; k++) printf(",%.15e", lifts[k]);
        printf("\npeak,%s", cases[i].name);
        print_peaks(peak);
    }
    for (int run = 0; run < 32; run++) {
        Train train = ready(9000, 1, 1);
        double factors[3];
        for (int axis = 1; axis <= 3; axis++) {
            /* Roberts' sequence fills the cube evenly. */
            double place = 0.5 + run * pow(1.2207440846057596, -axis);
            factors[axis - 1] = 1 + 0.2 * (2 * (place - floor(place)) - 1);
        }
        train.stiffness *= factors[0];
        train.damping *= factors[1];
        train.play[0] *= factors[2];
        train.play[1] *= factors[2];
        Run moving = start(DP5, 3e-12);
        double turn = 2 * PI / train.speed, peak[6];
        advance(&train, &moving, 2 * turn);
        for (int k = 3; k <= 5; k++) {
            peaks(&train, &moving, k * turn, RUN_SAMPLES, peak, NULL);
            printf("run,%d,%.15f,%.15f,%.15f", k, factors[0], factors[1], factors[2]);
            print_peaks(peak);
        }
    }
}

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e9 * time.tv_sec + time.tv_nsec;
}

static void turn(const char *method, double tolerance, double play, int rounds) {
    Train train = ready(9000, play, 0);
    tabulate(&train.opener);
    tabulate(&train.closer);
    double times[128], lifts[LEGS], span = 2 * PI / train.speed;
    long evaluations = 0;
    rounds = rounds < 1 ? 1 : rounds > 127 ? 127 : rounds;
    /* The first round warms up. */
    for (int round = 0; round <= rounds; round++) {
        Run run = start(strcmp(method, "rk4") ? strcmp(method, "dp5") ? DP8 : DP5 : RK4, tolerance);
        double begun = now();
        for (int leg = 1; leg <= LEGS; leg++) {
            advance(&train, &run, span * leg / LEGS);
            lifts[leg - 1] = run.y[2];
        }
        times[round] = now() - begun;
        evaluations = run.evaluations;
    }
    for (int k = 0; k < LEGS; k++) printf("%.15e%c", lifts[k], k + 1 < LEGS ? ',' : '\n');
    for (int k = 1; k <= rounds; k++) printf("%.0f%c", times[k], k < rounds ? ',' : '\n');
    printf("%ld\n", evaluations);
}

int main(int count, char **words) {
    if (count == 2 && !strcmp(words[1], "reference")) {
        reference();
    } else if (count == 6 && !strcmp(words[1], "turn")) {
        turn(words[2], atof(words[3]), atof(words[4]), atoi(words[5]));
    } else {
        fprintf(stderr, "valvetrain reference | valvetrain turn rk4|dp5|dp8 TOLERANCE PLAY ROUNDS\n");
        return 2;
    }
    return 0;
}
