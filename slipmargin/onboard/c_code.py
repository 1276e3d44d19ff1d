"""The part of the C header that is the same for every robot; tables and switches stand above it."""

from __future__ import annotations

#: Types and what the functions promise.
DECLARATIONS = """
#if defined(SM_REAL) /* a number type of your own, with SM_SQRT */
typedef SM_REAL sm_real;
#elif defined(SM_DOUBLE)
typedef double sm_real;
#define SM_SQRT(x) sqrt(x)
#else
typedef float sm_real;
#define SM_SINGLE 1
#define SM_SQRT(x) sqrtf(x)
#endif
#ifndef SM_SINGLE
#define SM_SINGLE 0
#endif
#define SM_C(x) ((sm_real)(x))

/* Velocity of the body frame's origin in body axes, and yaw rate. */
typedef struct { sm_real vx_m_s, vy_m_s, wz_rad_s; } sm_twist;
/* Acceleration of the body frame's origin in body axes, and yaw acceleration. */
typedef struct { sm_real ax_m_s2, ay_m_s2, alpha_rad_s2; } sm_acceleration;

/* What a limiting function did. */
typedef enum {
  SM_REACHED = 0, /* all that was wanted */
  SM_CUT = 1,     /* cut back, direction kept */
  SM_BRAKED = 2,  /* no step towards what was wanted holds: it brakes */
  SM_OVER = 3,    /* nothing keeps the margin: half-way between what misses it least */
  SM_NO_INPUT = 4 /* an input is no finite number, or no time passed */
} sm_code;
"""

#: Friction, external forces, and the rows that limit an acceleration.
ROWS = """
/* One row: a . acceleration of the centre of mass <= b. */
typedef struct { sm_real a[3], b; } sm_row;

static inline sm_real sm_least_of(sm_real x, sm_real y) { return x < y ? x : y; }
static inline sm_real sm_most_of(sm_real x, sm_real y) { return x > y ? x : y; }
static inline sm_real sm_size(sm_real x) { return x < SM_C(0) ? -x : x; }
static inline sm_real sm_between(sm_real x, sm_real low, sm_real high) {
  return x < low ? low : (x > high ? high : x);
}
static inline int sm_is_number(sm_real x) { return x - x == SM_C(0); }
static inline sm_real sm_dot(const sm_real *x, const sm_real *y) {
  return x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
}

/* Share of its grip that a contact uses at z = k u. */
static inline sm_real sm_friction(sm_real z) {
#if SM_LAW == 0 /* (2/pi) atan z: the angle is halved twice, then its series */
  const sm_real size = sm_size(z);
  const int large = size > SM_C(1);
  sm_real x = large ? SM_C(1) / size : size, x2, series;
  x = x / (SM_C(1) + SM_SQRT(SM_C(1) + x * x));
  x = x / (SM_C(1) + SM_SQRT(SM_C(1) + x * x));
  x2 = x * x;
#if !SM_SINGLE
  series = -SM_C(1) / SM_C(19) + x2 * (SM_C(1) / SM_C(21) - x2 / SM_C(23));
  series = -SM_C(1) / SM_C(15) + x2 * (SM_C(1) / SM_C(17) + x2 * series);
  series = -SM_C(1) / SM_C(11) + x2 * (SM_C(1) / SM_C(13) + x2 * series);
#else
  series = -SM_C(1) / SM_C(11);
#endif
  series = -SM_C(1) / SM_C(7) + x2 * (SM_C(1) / SM_C(9) + x2 * series);
  series = -SM_C(1) / SM_C(3) + x2 * (SM_C(1) / SM_C(5) + x2 * series);
  x = SM_C(4) * (x + x * x2 * series) * SM_C(0.63661977236758134308);
  if (large) x = SM_C(1) - x;
  return z < SM_C(0) ? -x : x;
#elif SM_LAW == 1 /* tanh z: a continued fraction at z/32, doubled five times */
  const sm_real x = sm_between(z, SM_C(-20), SM_C(20)) / SM_C(32), x2 = x * x;
  sm_real t = SM_C(9) + x2 / SM_C(11);
  int k;
  t = SM_C(5) + x2 / (SM_C(7) + x2 / t);
  t = x / (SM_C(1) + x2 / (SM_C(3) + x2 / t));
  for (k = 0; k < 5; ++k) t = SM_C(2) * t / (SM_C(1) + t * t);
  return t;
#else /* z / sqrt(1 + z^2) */
  return z / SM_SQRT(SM_C(1) + z * z);
#endif
}

/* Least and greatest drag per load at a twist. */
static inline void sm_drag(const sm_real *twist, sm_real *low, sm_real *high) {
  int i;
  for (i = 0; i < SM_WHEELS; ++i) {
    const sm_real slide = sm_dot(sm_lateral[i], twist);
#if SM_EXACT_DRAG
    low[i] = high[i] = sm_drag_high[i] * sm_friction(sm_slope_high[i] * slide);
#else
    const sm_real less = sm_drag_low[i] * sm_friction(sm_slope_low[i] * slide);
    const sm_real more = sm_drag_high[i] * sm_friction(sm_slope_high[i] * slide);
    low[i] = sm_least_of(less, more);
    high[i] = sm_most_of(less, more);
#endif
  }
}

/* Drive coefficient of wheel i that a drag leaves. */
static inline sm_real sm_drive_left(int i, sm_real drag) {
#if SM_COUPLED
  const sm_real whole = SM_COUPLED == 2 ? sm_most_of(sm_drag_high[i], SM_C(1e-30)) : sm_drive[i];
  const sm_real t = sm_between(drag / whole, SM_C(0), SM_C(1));
  return sm_drive[i] * (SM_C(1) - SM_COUPLING * (SM_C(1) - SM_SQRT(SM_C(1) - t * t)));
#else
  (void)drag;
  return sm_drive[i];
#endif
}

/* Least load of a wheel without acceleration. */
static inline sm_real sm_least_rest(int which, int i) {
#if SM_EXACT_REST
  return sm_rest[which][i];
#else
  return sm_rest[which][i] - sm_rest_half[which][i];
#endif
}

#if SM_MOTOR
/* Torque that the motor of wheel i gives with a sign while the twist goes from start to end. */
static inline sm_real sm_torque(int i, sm_real sign, const sm_real *start, const sm_real *end) {
#if SM_TOP_SPEED
  const sm_real from = sign * sm_dot(sm_rolling[i], start), to = sign * sm_dot(sm_rolling[i], end);
  const sm_real fastest = sm_most_of(sm_most_of(from, to), SM_C(0));
  return SM_STALL * sm_most_of(SM_C(1) - fastest * (SM_C(1) / SM_FASTEST), SM_C(0));
#else
  (void)i; (void)sign; (void)start; (void)end;
  return SM_STALL;
#endif
}
#endif

/* External wrench (the middle of its range) and the change of the loads by the slope at a heading. */
static inline void sm_external(const sm_real *twist, sm_real heading, sm_real *wrench, sm_real *shift) {
  int i;
  for (i = 0; i < 3; ++i) wrench[i] = sm_wrench[i] + sm_dot(sm_viscous[i], twist);
  for (i = 0; i < SM_WHEELS; ++i) shift[i] = SM_C(0);
#if SM_FLOOR
  {
    const sm_real turn = SM_C(6.28318530717958647693);
    const sm_real count = heading / turn + (heading < SM_C(0) ? -SM_C(0.5) : SM_C(0.5));
    const sm_real x = (heading - turn * (sm_real)(long)count) / SM_C(8), x2 = x * x;
    sm_real s = SM_C(1) / SM_C(362880) - x2 / SM_C(39916800);
    sm_real c = SM_C(1) / SM_C(40320) - x2 / SM_C(3628800) + x2 * x2 / SM_C(479001600);
    sm_real force[2];
    s = SM_C(1) / SM_C(120) + x2 * (-SM_C(1) / SM_C(5040) + x2 * (s + x2 * x2 / SM_C(6227020800.0)));
    s = x * (SM_C(1) + x2 * (-SM_C(1) / SM_C(6) + x2 * s));
    c = SM_C(1) / SM_C(24) + x2 * (-SM_C(1) / SM_C(720) + x2 * c);
    c = SM_C(1) + x2 * (-SM_C(0.5) + x2 * c);
    for (i = 0; i < 3; ++i) { /* three doublings */
      const sm_real s2 = SM_C(2) * s * c;
      c = SM_C(1) - SM_C(2) * s * s;
      s = s2;
    }
    force[0] = c * sm_floor[0] + s * sm_floor[1];
    force[1] = c * sm_floor[1] - s * sm_floor[0];
    for (i = 0; i < 2; ++i) wrench[i] += force[i];
    wrench[2] += sm_floor[2];
    for (i = 0; i < SM_WHEELS; ++i)
      shift[i] = sm_floor_loads[i][0] * force[0] + sm_floor_loads[i][1] * force[1];
  }
#else
  (void)heading;
#endif
}

/* How the wheels share a wrench: a table, or by their grip at the acceleration near_by.  Then it is the mean
   of what every three wheels would do alone, weighted by the product of their grips: nothing cancels. */
static inline void sm_sharing(const sm_real *left, const sm_real *shift, const sm_real *near_by,
                              sm_real spread[SM_WHEELS][3]) {
  int i, j;
#if SM_SHARES_BY_LOAD
  sm_real grip[SM_WHEELS], all = SM_C(0);
  int k;
  for (i = 0; i < SM_WHEELS; ++i) {
    const sm_real moved = sm_transfer[i][0] * near_by[0] + sm_transfer[i][1] * near_by[1];
    const sm_real share = sm_most_of(left[i], SM_LEAST_LEFT);
    grip[i] = share * sm_most_of(sm_least_rest(0, i) + shift[i] + moved, SM_LIGHTEST);
    for (j = 0; j < 3; ++j) spread[i][j] = SM_C(0);
  }
  for (k = 0; k < SM_THREES; ++k) {
    const int *of = sm_three[k];
    const sm_real weight = grip[of[0]] * grip[of[1]] * grip[of[2]];
    all += weight * sm_three_weight[k];
    for (i = 0; i < 3; ++i)
      for (j = 0; j < 3; ++j) spread[of[i]][j] += weight * sm_three_spread[k][i][j];
  }
  all = SM_C(1) / all;
  for (i = 0; i < SM_WHEELS; ++i)
    for (j = 0; j < 3; ++j) spread[i][j] *= all;
#else
  (void)left; (void)shift; (void)near_by;
  for (i = 0; i < SM_WHEELS; ++i)
    for (j = 0; j < 3; ++j) spread[i][j] = sm_spread[i][j];
#endif
}

/* Two rows: a part with either sign, and what is worst for both. */
static inline void sm_pair(sm_row *rows, const sm_row *mean, const sm_row *worst) {
  int k;
  for (k = 0; k < 3; ++k) {
    rows[0].a[k] = worst->a[k] + mean->a[k];
    rows[1].a[k] = worst->a[k] - mean->a[k];
  }
  rows[0].b = worst->b + mean->b;
  rows[1].b = worst->b - mean->b;
}

/* Adds a force per load of wheel j to a row. */
static inline void sm_add_load(sm_row *row, sm_real part, int j, sm_real load) {
#if SM_TRANSFERS
  row->a[0] += part * sm_transfer[j][0];
  row->a[1] += part * sm_transfer[j][1];
#else
  (void)j;
#endif
  row->b -= part * load;
}

#if !SM_EXACT_REST
/* What loads that are known within a band only take from two rows; part: force per drag of each wheel. */
static inline void sm_band(sm_row *rows, const sm_real *part, const sm_real *mid, const sm_real *half,
                           int which, int own, sm_real grip) {
  int j;
  for (j = 0; j < SM_WHEELS; ++j) {
    const sm_real worst = sm_size(part[j]) * half[j] - (j == own ? grip : SM_C(0));
    rows[0].b -= sm_size(worst + part[j] * mid[j]) * sm_rest_half[which][j];
    rows[1].b -= sm_size(worst - part[j] * mid[j]) * sm_rest_half[which][j];
  }
}
#endif

/* Rows on the acceleration a that hold while the twist goes from start, whose drag is known, to end.
   The drag per load of wheel j lies within mid +- half; cross = spread . across is its part of a force:
   |spread . (M a - w + across mid N(a))| + |cross| half N(a) <= share left N(a), with the load
   N(a) = load + transfer a. */
static inline void sm_rows(const sm_real *start, const sm_real *end, const sm_real *drag_low,
                           const sm_real *drag_high, sm_real heading, const sm_real *near_by, sm_row *rows) {
  const int wide = start != end || !SM_EXACT_DRAG;
  sm_real mid[SM_WHEELS], half[SM_WHEELS], left[SM_WHEELS], shift[SM_WHEELS], spread[SM_WHEELS][3];
  sm_real external[3], known[3];
  int i, j, k, which, at = 0;
  if (start != end) sm_drag(end, mid, half);
  for (i = 0; i < SM_WHEELS; ++i) {
    const sm_real low = start != end ? sm_least_of(mid[i], drag_low[i]) : drag_low[i];
    const sm_real high = start != end ? sm_most_of(half[i], drag_high[i]) : drag_high[i];
    mid[i] = SM_C(0.5) * (low + high);
    half[i] = SM_C(0.5) * (high - low);
    left[i] = sm_drive_left(i, sm_most_of(sm_size(low), sm_size(high)));
  }
  sm_external(start, heading, external, shift);
  sm_sharing(left, shift, near_by, spread);
  for (which = 0; which < SM_CASES; ++which) {
    sm_real load[SM_WHEELS];
#if SM_TRANSFERS
    sm_real by_x[3] = {SM_C(0), SM_C(0), SM_C(0)}, by_y[3] = {SM_C(0), SM_C(0), SM_C(0)};
#endif
    for (k = 0; k < 3; ++k) known[k] = external[k];
    for (j = 0; j < SM_WHEELS; ++j) {
      load[j] = sm_rest[which][j] + shift[j];
      for (k = 0; k < 3; ++k) {
        const sm_real drag = sm_across[j][k] * mid[j];
        known[k] -= drag * load[j];
#if SM_TRANSFERS
        by_x[k] += drag * sm_transfer[j][0];
        by_y[k] += drag * sm_transfer[j][1];
#endif
      }
    }
    for (i = 0; i < SM_WHEELS; ++i) {
      const sm_real *s = spread[i], grip = SM_SHARE * left[i];
      sm_row mean, worst = {{SM_C(0), SM_C(0), SM_C(0)}, SM_C(0)}, bound;
#if SM_MOTOR || !SM_EXACT_REST
      const sm_real own = sm_dot(s, sm_across[i]);
#endif
      for (k = 0; k < 3; ++k) mean.a[k] = s[k] * sm_mass[k];
#if SM_TRANSFERS
      mean.a[0] += sm_dot(s, by_x);
      mean.a[1] += sm_dot(s, by_y);
#endif
      mean.b = sm_dot(s, known);
      if (wide)
        for (j = 0; j < SM_WHEELS; ++j)
          sm_add_load(&worst, sm_size(sm_dot(s, sm_across[j])) * half[j], j, load[j]);
#if !SM_EXACT_WRENCH
      for (k = 0; k < 3; ++k) worst.b -= sm_size(s[k]) * sm_wrench_half[k];
#endif
      bound = worst;
      sm_add_load(&bound, -grip, i, load[i]);
      sm_pair(rows + at, &mean, &bound);
#if !SM_EXACT_REST
      {
        sm_real cross[SM_WHEELS];
        for (j = 0; j < SM_WHEELS; ++j) cross[j] = sm_dot(s, sm_across[j]);
        sm_band(rows + at, cross, mid, half, which, i, grip);
      }
#endif
      at += 2;
#if SM_MOTOR
      {
        const sm_real force = sm_torque_force[i], size = sm_size(force), direct = sm_torque_drag[i];
        for (k = 0; k < 3; ++k) { mean.a[k] *= force; worst.a[k] *= size; }
        mean.b *= force;
        worst.b *= size;
        sm_add_load(&mean, direct * mid[i], i, load[i]);
        if (wide)
          sm_add_load(&worst, (sm_size(force * own + direct) - size * sm_size(own)) * half[i], i, load[i]);
        sm_pair(rows + at, &mean, &worst);
#if !SM_EXACT_REST
        {
          sm_real cross[SM_WHEELS];
          for (j = 0; j < SM_WHEELS; ++j)
            cross[j] = force * sm_dot(s, sm_across[j]) + (i == j ? direct : SM_C(0));
          sm_band(rows + at, cross, mid, half, which, -1, SM_C(0));
        }
#endif
        rows[at].b += SM_SHARE * sm_torque(i, SM_C(1), start, end);
        rows[at + 1].b += SM_SHARE * sm_torque(i, SM_C(-1), start, end);
        at += 2;
      }
#endif
    }
  }
#if SM_TRANSFERS
  for (i = 0; i < SM_WHEELS; ++i) {
    rows[at].a[0] = -sm_transfer[i][0];
    rows[at].a[1] = -sm_transfer[i][1];
    rows[at].a[2] = SM_C(0);
    rows[at++].b = SM_SHARE * (sm_least_rest(0, i) + shift[i]);
  }
#endif
}
"""
