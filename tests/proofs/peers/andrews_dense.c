/* Accelerations of Andrews' squeezing mechanism by hand: mass matrix, rows and forces of the IVP test set in C, and a
   dense LU factorization with partial pivoting of M q'' + J' lambda = f, J q'' = gamma. */
#define _GNU_SOURCE
#include <math.h>

enum { N = 7, M = 6, SIZE = N + M };

static const double rr = 0.007, ra = 0.00092, d = 0.028, da = 0.0115, e = 0.02, ea = 0.01421, ss = 0.035, sa = 0.01874,
                    sb = 0.01043, sc = 0.018, sd = 0.02, ta = 0.02308, tb = 0.00916, u = 0.04, ua = 0.01228, ub = 0.00449,
                    zf = 0.02, zt = 0.04, fa = 0.01421;
static const double xb = -0.03635, yb = 0.03273, xc = 0.014, yc = 0.072, c0 = 4530, l0 = 0.07785, mom = 0.033;
static const double m1 = 0.04325, m2 = 0.00365, m3 = 0.02373, m4 = 0.00706, m5 = 0.07050, m6 = 0.00706, m7 = 0.05498;
static const double i1 = 2.194e-6, i2 = 4.410e-7, i3 = 5.255e-6, i4 = 5.667e-7, i5 = 1.169e-5, i6 = 5.667e-7,
                    i7 = 1.912e-5;

/* Solves a x = b in place; a is lost. */
static void solve(double a[SIZE][SIZE], double b[SIZE]) {
    for (int k = 0; k < SIZE; k++) {
        int largest = k;
        for (int i = k + 1; i < SIZE; i++)
            if (fabs(a[i][k]) > fabs(a[largest][k])) largest = i;
        if (largest != k) {
            for (int j = k; j < SIZE; j++) {
                const double entry = a[k][j];
                a[k][j] = a[largest][j];
                a[largest][j] = entry;
            }
            const double right = b[k];
            b[k] = b[largest];
            b[largest] = right;
        }
        const double reciprocal = 1 / a[k][k];
        for (int i = k + 1; i < SIZE; i++) {
            const double multiplier = a[i][k] * reciprocal;
            if (multiplier == 0) continue;
            for (int j = k + 1; j < SIZE; j++) a[i][j] -= multiplier * a[k][j];
            b[i] -= multiplier * b[k];
        }
    }
    for (int i = SIZE - 1; i >= 0; i--) {
        double rest = b[i];
        for (int j = i + 1; j < SIZE; j++) rest -= a[i][j] * b[j];
        b[i] = rest / a[i][i];
    }
}

static inline void enter(double a[SIZE][SIZE], int row, int column, double entry) {
    a[row][column] = entry;
    a[column][row] = entry;
}

void dense_andrews(const double *q, const double *v, double *accelerations) {
    double sbe, cbe, sbt, cbt, sga, cga, spd, cpd, sde, cde, soe, coe, sep, cep, sth, cth, sph, cph, som, com;
    sincos(q[0], &sbe, &cbe);
    sincos(q[0] + q[1], &sbt, &cbt);
    sincos(q[2], &sga, &cga);
    sincos(q[3] + q[4], &spd, &cpd);
    sincos(q[4], &sde, &cde);
    sincos(q[5] + q[6], &soe, &coe);
    sincos(q[6], &sep, &cep);
    sincos(q[1], &sth, &cth);
    sincos(q[3], &sph, &cph);
    sincos(q[5], &som, &com);
    const double bt = v[0] + v[1], pd = v[3] + v[4], oe = v[5] + v[6];
    double a[SIZE][SIZE] = {{0}}, b[SIZE];

    const double upper = e - ea, lower = zf - fa;
    a[0][0] = m1 * ra * ra + m2 * (rr * rr - 2 * da * rr * cth + da * da) + i1 + i2;
    enter(a, 1, 0, m2 * (da * da - da * rr * cth) + i2);
    a[1][1] = m2 * da * da + i2;
    a[2][2] = m3 * (sa * sa + sb * sb) + i3;
    a[3][3] = m4 * upper * upper + i4;
    enter(a, 4, 3, m4 * (upper * upper + zt * upper * sph) + i4);
    a[4][4] = m4 * (zt * zt + 2 * zt * upper * sph + upper * upper) + m5 * (ta * ta + tb * tb) + i4 + i5;
    a[5][5] = m6 * lower * lower + i6;
    enter(a, 6, 5, m6 * (lower * lower - u * lower * som) + i6);
    a[6][6] = m6 * (lower * lower - 2 * u * lower * som + u * u) + m7 * (ua * ua + ub * ub) + i6 + i7;

    const double xd = sd * cga + sc * sga + xb - xc, yd = sd * sga - sc * cga + yb - yc;
    const double length = sqrt(xd * xd + yd * yd), pull = -c0 * (length - l0) / length;
    b[0] = mom - m2 * da * rr * v[1] * (v[1] + 2 * v[0]) * sth;
    b[1] = m2 * da * rr * v[0] * v[0] * sth;
    b[2] = pull * (xd * (sc * cga - sd * sga) + yd * (sd * cga + sc * sga));
    b[3] = m4 * zt * upper * v[4] * v[4] * cph;
    b[4] = -m4 * zt * upper * v[3] * (v[3] + 2 * v[4]) * cph;
    b[5] = -m6 * u * lower * v[6] * v[6] * com;
    b[6] = m6 * u * lower * v[5] * (v[5] + 2 * v[6]) * com;

    const double x = rr * cbe - d * cbt, y = rr * sbe - d * sbt;
    for (int row = N; row < SIZE; row += 2) {
        enter(a, row, 0, -y);
        enter(a, row, 1, d * sbt);
        enter(a, row + 1, 0, x);
        enter(a, row + 1, 1, -d * cbt);
    }
    enter(a, 7, 2, -ss * cga);
    enter(a, 8, 2, -ss * sga);
    enter(a, 9, 3, -e * cpd);
    enter(a, 9, 4, zt * sde - e * cpd);
    enter(a, 10, 3, -e * spd);
    enter(a, 10, 4, -zt * cde - e * spd);
    enter(a, 11, 5, zf * soe);
    enter(a, 11, 6, zf * soe - u * cep);
    enter(a, 12, 5, -zf * coe);
    enter(a, 12, 6, -zf * coe - u * sep);

    const double gx = rr * cbe * v[0] * v[0] - d * cbt * bt * bt, gy = rr * sbe * v[0] * v[0] - d * sbt * bt * bt;
    b[7] = gx - ss * sga * v[2] * v[2];
    b[8] = gy + ss * cga * v[2] * v[2];
    b[9] = gx - e * spd * pd * pd - zt * cde * v[4] * v[4];
    b[10] = gy + e * cpd * pd * pd - zt * sde * v[4] * v[4];
    b[11] = gx - zf * coe * oe * oe - u * sep * v[6] * v[6];
    b[12] = gy - zf * soe * oe * oe + u * cep * v[6] * v[6];

    solve(a, b);
    for (int k = 0; k < N; k++) accelerations[k] = b[k];
}
