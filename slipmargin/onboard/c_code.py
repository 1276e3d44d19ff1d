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

/* External wrench (least, greatest) and the change of the loads by the slope at a heading. */
static inline void sm_external(const sm_real *twist, sm_real heading, sm_real *low, sm_real *high,
                               sm_real *shift) {
  int i;
  for (i = 0; i < 3; ++i) {
    const sm_real viscous = sm_dot(sm_viscous[i], twist);
    low[i] = sm_wrench_low[i] + viscous;
    high[i] = sm_wrench_high[i] + viscous;
  }
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
    for (i = 0; i < 2; ++i) { low[i] += force[i]; high[i] += force[i]; }
    low[2] += sm_floor[2];
    high[2] += sm_floor[2];
    for (i = 0; i < SM_WHEELS; ++i)
      shift[i] = sm_floor_loads[i][0] * force[0] + sm_floor_loads[i][1] * force[1];
  }
#else
  (void)heading;
#endif
}

/* How the wheels share a wrench: a table, or by their grip at the acceleration near_by. */
static inline void sm_sharing(const sm_real *left, const sm_real *shift, const sm_real *near_by,
                              sm_real spread[SM_WHEELS][3]) {
  int i, j;
#if SM_SHARES_BY_LOAD
  sm_real grip[SM_WHEELS], m[6] = {0, 0, 0, 0, 0, 0}, n[6], det;
  for (i = 0; i < SM_WHEELS; ++i) {
    const sm_real moved = sm_transfer[i][0] * near_by[0] + sm_transfer[i][1] * near_by[1];
    const sm_real *b = sm_along[i];
    const sm_real share = sm_most_of(left[i], SM_LEAST_LEFT);
    grip[i] = share * sm_most_of(sm_rest_low[0][i] + shift[i] + moved, SM_LIGHTEST);
    m[0] += grip[i] * b[0] * b[0];
    m[1] += grip[i] * b[0] * b[1];
    m[2] += grip[i] * b[0] * b[2];
    m[3] += grip[i] * b[1] * b[1];
    m[4] += grip[i] * b[1] * b[2];
    m[5] += grip[i] * b[2] * b[2];
  }
  n[0] = m[3] * m[5] - m[4] * m[4];
  n[1] = m[2] * m[4] - m[1] * m[5];
  n[2] = m[1] * m[4] - m[2] * m[3];
  n[3] = m[0] * m[5] - m[2] * m[2];
  n[4] = m[1] * m[2] - m[0] * m[4];
  n[5] = m[0] * m[3] - m[1] * m[1];
  det = SM_C(1) / (m[0] * n[0] + m[1] * n[1] + m[2] * n[2]);
  for (i = 0; i < SM_WHEELS; ++i) {
    const sm_real *b = sm_along[i];
    const sm_real scale = grip[i] * det;
    spread[i][0] = scale * (n[0] * b[0] + n[1] * b[1] + n[2] * b[2]);
    spread[i][1] = scale * (n[1] * b[0] + n[3] * b[1] + n[4] * b[2]);
    spread[i][2] = scale * (n[2] * b[0] + n[4] * b[1] + n[5] * b[2]);
  }
  (void)j;
#else
  (void)left; (void)shift; (void)near_by;
  for (i = 0; i < SM_WHEELS; ++i)
    for (j = 0; j < 3; ++j) spread[i][j] = sm_spread[i][j];
#endif
}

/* The row spread . (M a - w) + sum of per_load . N(a) <= room. */
static inline sm_row sm_make_row(const sm_real *spread, const sm_real *per_load, const sm_real *wrench_low,
                                 const sm_real *wrench_high, int which, const sm_real *shift, sm_real room) {
  sm_row row;
  int j;
  for (j = 0; j < 3; ++j) {
    row.a[j] = spread[j] * sm_mass[j];
    room += spread[j] * (spread[j] > SM_C(0) ? wrench_low[j] : wrench_high[j]);
  }
  for (j = 0; j < SM_WHEELS; ++j) {
    const sm_real rest = per_load[j] > SM_C(0) ? sm_rest_high[which][j] : sm_rest_low[which][j];
#if SM_TRANSFERS
    row.a[0] += per_load[j] * sm_transfer[j][0];
    row.a[1] += per_load[j] * sm_transfer[j][1];
#endif
    room -= per_load[j] * (rest + shift[j]);
  }
  row.b = room;
  return row;
}

/* Rows on the acceleration that hold while the twist goes from start, whose drag is known, to end. */
static inline void sm_rows(const sm_real *start, const sm_real *end, const sm_real *drag_low,
                           const sm_real *drag_high, sm_real heading, const sm_real *near_by, sm_row *rows) {
  sm_real low[SM_WHEELS], high[SM_WHEELS], left[SM_WHEELS], shift[SM_WHEELS], per_load[SM_WHEELS];
  sm_real spread[SM_WHEELS][3], wrench_low[3], wrench_high[3], signed_spread[3];
  int i, j, which, side, at = 0;
  if (start != end) {
    sm_drag(end, low, high);
    for (i = 0; i < SM_WHEELS; ++i) {
      low[i] = sm_least_of(low[i], drag_low[i]);
      high[i] = sm_most_of(high[i], drag_high[i]);
    }
  } else {
    for (i = 0; i < SM_WHEELS; ++i) { low[i] = drag_low[i]; high[i] = drag_high[i]; }
  }
  for (i = 0; i < SM_WHEELS; ++i)
    left[i] = sm_drive_left(i, sm_most_of(sm_size(low[i]), sm_size(high[i])));
  sm_external(start, heading, wrench_low, wrench_high, shift);
  sm_sharing(left, shift, near_by, spread);
  for (i = 0; i < SM_WHEELS; ++i) {
    sm_real cross[SM_WHEELS];
#if SM_MOTOR
    const sm_real spin[2] = {sm_dot(sm_rolling[i], start), sm_dot(sm_rolling[i], end)};
#endif
    for (j = 0; j < SM_WHEELS; ++j) cross[j] = sm_dot(spread[i], sm_across[j]);
    for (side = 0; side < 2; ++side) {
      const sm_real sign = side ? SM_C(-1) : SM_C(1);
      for (j = 0; j < SM_WHEELS; ++j) {
        const sm_real part = sign * cross[j];
        per_load[j] = part * (part > SM_C(0) ? high[j] : low[j]);
      }
      per_load[i] -= SM_SHARE * left[i];
      for (j = 0; j < 3; ++j) signed_spread[j] = sign * spread[i][j];
      for (which = 0; which < SM_CASES; ++which)
        rows[at++] = sm_make_row(signed_spread, per_load, wrench_low, wrench_high, which, shift, SM_C(0));
#if SM_MOTOR
      {
        const sm_real force = sign * sm_torque_force[i];
        sm_real torque = SM_STALL;
#if SM_TOP_SPEED
        const sm_real fastest = sm_most_of(sm_most_of(sign * spin[0], sign * spin[1]), SM_C(0));
        torque *= sm_most_of(SM_C(1) - fastest / SM_FASTEST, SM_C(0));
#else
        (void)spin;
#endif
        for (j = 0; j < SM_WHEELS; ++j) {
          const sm_real part = force * cross[j] + (i == j ? sign * sm_torque_drag[i] : SM_C(0));
          per_load[j] = part * (part > SM_C(0) ? high[j] : low[j]);
        }
        for (j = 0; j < 3; ++j) signed_spread[j] = force * spread[i][j];
        for (which = 0; which < SM_CASES; ++which)
          rows[at++] = sm_make_row(signed_spread, per_load, wrench_low, wrench_high, which, shift,
                                   SM_SHARE * torque);
      }
#endif
    }
#if SM_TRANSFERS
    rows[at].a[0] = -sm_transfer[i][0];
    rows[at].a[1] = -sm_transfer[i][1];
    rows[at].a[2] = SM_C(0);
    rows[at++].b = SM_SHARE * (sm_rest_low[0][i] + shift[i]);
#endif
  }
}
"""
