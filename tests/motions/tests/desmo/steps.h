/* Runge and Kutta's method of order 4 with steps of equal size; Dormand and Prince's pairs of orders 5(4) and 8(5,3) with steps by
 * the estimated error. Sources: Hairer, Norsett & Wanner 1993, tables II.1.2 and II.5.2, code DOP853. */

typedef enum { RK4, DP5, DP8 } Method;

typedef struct {
    Method method;
    double tolerance, t, h, y[6];
    long evaluations;
} Run;

static Run start(Method method, double tolerance) {
    Run run = {.method = method, .tolerance = tolerance, .h = 1e-9};
    return run;
}

/* Stage `n` at the share `c` of the step. */
#define STAGE(n, c, sum)                                  \
    for (int i = 0; i < 6; i++) next[i] = y[i] + h * (sum); \
    rates(train, t + (c) * h, next, k[n], force)

static void step_rk4(const Train *train, double t, double h, double y[6], double k[13][6]) {
    double next[6], force[5];
    rates(train, t, y, k[0], force);
    STAGE(1, 0.5, 0.5 * k[0][i]);
    STAGE(2, 0.5, 0.5 * k[1][i]);
    STAGE(3, 1.0, k[2][i]);
    for (int i = 0; i < 6; i++) y[i] += h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
}

/* The largest of the errors over what `tolerance` allows: positions count in units of 0.1, rates in units of 100. */
static double over(const double error[6], const double y[6], const double next[6], double tolerance) {
    double most = 0;
    for (int i = 0; i < 6; i++) {
        double allowed = tolerance * ((i < 3 ? 0.1 : 100) + fmax(fabs(y[i]), fabs(next[i])));
        most = fmax(most, fabs(error[i]) / allowed);
    }
    return most;
}

/* A trial of order 5; `k[0]` is known, `k[6]` is the rate at its end. Returns its error over the tolerance. */
static double try_dp5(const Train *train, double t, double h, const double y[6], double next[6], double k[13][6],
                      double tolerance) {
    double force[5], error[6];
    STAGE(1, 0.2, 0.2 * k[0][i]);
    STAGE(2, 0.3, 3.0 / 40 * k[0][i] + 9.0 / 40 * k[1][i]);
    STAGE(3, 0.8, 44.0 / 45 * k[0][i] - 56.0 / 15 * k[1][i] + 32.0 / 9 * k[2][i]);
    STAGE(4, 8.0 / 9, 19372.0 / 6561 * k[0][i] - 25360.0 / 2187 * k[1][i] + 64448.0 / 6561 * k[2][i]
                          - 212.0 / 729 * k[3][i]);
    STAGE(5, 1.0, 9017.0 / 3168 * k[0][i] - 355.0 / 33 * k[1][i] + 46732.0 / 5247 * k[2][i] + 49.0 / 176 * k[3][i]
                      - 5103.0 / 18656 * k[4][i]);
    STAGE(6, 1.0, 35.0 / 384 * k[0][i] + 500.0 / 1113 * k[2][i] + 125.0 / 192 * k[3][i] - 2187.0 / 6784 * k[4][i]
                      + 11.0 / 84 * k[5][i]);
    for (int i = 0; i < 6; i++) {
        error[i] = h * (71.0 / 57600 * k[0][i] - 71.0 / 16695 * k[2][i] + 71.0 / 1920 * k[3][i]
                        - 17253.0 / 339200 * k[4][i] + 22.0 / 525 * k[5][i] - 1.0 / 40 * k[6][i]);
    }
    return over(error, y, next, tolerance);
}

/* A trial of order 8; `k[0]` is known, `k[12]` is the rate at its end. Returns its error over the tolerance. */
static double try_dp8(const Train *train, double t, double h, const double y[6], double next[6], double k[13][6],
                      double tolerance) {
    double force[5], fifth[6], third[6];
        STAGE(1, 0.05260015195876773, 0.05260015195876773 * k[0][i]);
        STAGE(2, 0.0789002279381516, 0.0197250569845379 * k[0][i] + 0.0591751709536137 * k[1][i]);
        STAGE(3, 0.1183503419072274, 0.02958758547680685 * k[0][i] + 0.08876275643042054 * k[2][i]);
        STAGE(4, 0.2816496580927726, 0.2413651341592667 * k[0][i] + -0.8845494793282861 * k[2][i] +
          0.924834003261792 * k[3][i]);
        STAGE(5, 0.3333333333333333, 0.037037037037037035 * k[0][i] + 0.17082860872947386 * k[3][i] +
          0.12546768756682242 * k[4][i]);
        STAGE(6, 0.25, 0.037109375 * k[0][i] + 0.17025221101954405 * k[3][i] + 0.06021653898045596 * k[4][i] +
          -0.017578125 * k[5][i]);
        STAGE(7, 0.3076923076923077, 0.03709200011850479 * k[0][i] + 0.17038392571223998 * k[3][i] +
          0.10726203044637328 * k[4][i] + -0.015319437748624402 * k[5][i] + 0.008273789163814023 * k[6][i]);
        STAGE(8, 0.6512820512820513, 0.6241109587160757 * k[0][i] + -3.3608926294469414 * k[3][i] +
          -0.868219346841726 * k[4][i] + 27.59209969944671 * k[5][i] + 20.154067550477894 * k[6][i] +
          -43.48988418106996 * k[7][i]);
        STAGE(9, 0.6, 0.47766253643826434 * k[0][i] + -2.4881146199716677 * k[3][i] + -0.590290826836843 * k[4][i] +
          21.230051448181193 * k[5][i] + 15.279233632882423 * k[6][i] + -33.28821096898486 * k[7][i] +
          -0.020331201708508627 * k[8][i]);
        STAGE(10, 0.8571428571428571, -0.9371424300859873 * k[0][i] + 5.186372428844064 * k[3][i] +
          1.0914373489967295 * k[4][i] + -8.149787010746927 * k[5][i] + -18.52006565999696 * k[6][i] +
          22.739487099350505 * k[7][i] + 2.4936055526796523 * k[8][i] + -3.0467644718982196 * k[9][i]);
        STAGE(11, 1.0, 2.273310147516538 * k[0][i] + -10.53449546673725 * k[3][i] + -2.0008720582248625 * k[4][i] +
          -17.9589318631188 * k[5][i] + 27.94888452941996 * k[6][i] + -2.8589982771350235 * k[7][i] +
          -8.87285693353063 * k[8][i] + 12.360567175794303 * k[9][i] + 0.6433927460157636 * k[10][i]);
    STAGE(12, 1.0, 0.054293734116568765 * k[0][i] + 4.450312892752409 * k[5][i] + 1.8915178993145003 * k[6][i] +
          -5.801203960010585 * k[7][i] + 0.3111643669578199 * k[8][i] + -0.1521609496625161 *
          k[9][i] + 0.20136540080403034 * k[10][i] + 0.04471061572777259 * k[11][i]);
    for (int i = 0; i < 6; i++) {
        fifth[i] = h * (0.01312004499419488 * k[0][i] + -1.2251564463762044 * k[5][i] + -0.4957589496572502 * k[6][i] +
             1.6643771824549864 * k[7][i] + -0.35032884874997366 * k[8][i] + 0.3341791187130175 *
             k[9][i] + 0.08192320648511571 * k[10][i] + -0.022355307863886294 * k[11][i]);
        third[i] = h * (-0.18980075407240762 * k[0][i] + 4.450312892752409 * k[5][i] + 1.8915178993145003 * k[6][i] +
             -5.801203960010585 * k[7][i] + -0.4226823213237919 * k[8][i] + -0.1521609496625161 *
             k[9][i] + 0.20136540080403034 * k[10][i] + 0.02265179219836082 * k[11][i]);
    }
    double a = over(fifth, y, next, tolerance), b = over(third, y, next, tolerance);
    return a == 0 ? 0 : a * a / sqrt(a * a + 0.01 * b * b);
}

/* Moves on to `until` (s); `rk4`: in `tolerance` equal steps. */
static void advance(const Train *train, Run *run, double until) {
    double k[13][6], next[6], force[5];
    if (run->method == RK4) {
        double from = run->t;
        int steps = (int)run->tolerance;
        for (int s = 0; s < steps; s++) step_rk4(train, from + (until - from) * s / steps, (until - from) / steps, run->y, k);
        run->t = until;
        run->evaluations += 4 * steps;
        return;
    }
    int last = run->method == DP8 ? 12 : 6;
    double power = run->method == DP8 ? -0.125 : -0.2;
    rates(train, run->t, run->y, k[0], force);
    run->evaluations++;
    while (run->t < until) {
        double rest = until - run->t, h = fmin(run->h, rest);
        double error = last == 12 ? try_dp8(train, run->t, h, run->y, next, k, run->tolerance)
                                  : try_dp5(train, run->t, h, run->y, next, k, run->tolerance);
        run->evaluations += last;
        if (error <= 1) {
            run->t = h < rest ? run->t + h : until;
            memcpy(run->y, next, sizeof next);
            memcpy(k[0], k[last], sizeof next);
        }
        /* A step that the end has cut says little of the next one. */
        if (error > 1 || h >= run->h) run->h = h * fmin(6, fmax(0.2, 0.9 * pow(fmax(error, 1e-10), power)));
    }
}
