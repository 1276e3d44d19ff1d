"""What the C header promises, and the functions that a robot calls."""

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

#: The functions.
CALLS = """
/* Greatest share of a range; 0 where there is none, and then the middle of the miss. */
static inline int sm_pick(const sm_range *range, sm_real *t) {
  const int holds = range->least <= range->most;
  if (holds) *t = sm_least_of(range->most, sm_most_of(range->ends, range->least));
  else *t = SM_C(0.5) * (sm_least_of(range->least, SM_C(1)) + sm_most_of(range->most, SM_C(0)));
  return holds;
}

/* Acceleration of the centre of mass by turning at the twist v + t d. */
static inline void sm_turning(const sm_real *v, const sm_real *d, sm_course *course) {
  sm_real *at = course->at, *turn = course->turn, *curl = course->curl;
  course->turns = 1;
  at[0] = -v[2] * v[1] - v[2] * v[2] * sm_com[0];
  at[1] = v[2] * v[0] - v[2] * v[2] * sm_com[1];
  turn[0] = -(v[2] * d[1] + d[2] * v[1]) - SM_C(2) * v[2] * d[2] * sm_com[0];
  turn[1] = v[2] * d[0] + d[2] * v[0] - SM_C(2) * v[2] * d[2] * sm_com[1];
  curl[0] = -d[2] * d[1] - d[2] * d[2] * sm_com[0];
  curl[1] = d[2] * d[0] - d[2] * d[2] * sm_com[1];
  at[2] = turn[2] = curl[2] = SM_C(0);
}

/* What the centre of mass gets by the yaw rate alone. */
static inline void sm_outwards(const sm_real *v, sm_real *out) {
  out[0] = -v[2] * v[2] * sm_com[0];
  out[1] = -v[2] * v[2] * sm_com[1];
  out[2] = SM_C(0);
}

/* Of an acceleration of the origin, what the centre of mass gets of it. */
static inline void sm_to_centre(const sm_real *a, sm_real *out) {
  out[0] = a[0] - a[2] * sm_com[1];
  out[1] = a[1] + a[2] * sm_com[0];
  out[2] = a[2];
}

/* One step from now towards a target; 0 where no part of it keeps the margin. */
static inline int sm_toward(const sm_real *now, const sm_real *drag_low, const sm_real *drag_high,
                            const sm_real *target, sm_real dt, sm_real heading, sm_real *next) {
  sm_real step[3], near_by[3], end[3], far_, t = SM_C(0);
  sm_course course;
  const sm_real *c = course.at, *rate = course.rate;
  sm_range range;
  int j, part, holds;
  for (j = 0; j < 3; ++j) {
    step[j] = target[j] - now[j];
    course.gain[j] = step[j] / dt;
    course.gain0[j] = SM_C(0);
  }
  sm_turning(now, step, &course);
  sm_to_centre(course.gain, course.rate);
  far_ = SM_PULL / sm_most_of(SM_SQRT(rate[0] * rate[0] + rate[1] * rate[1]), SM_PULL);
  for (j = 0; j < 3; ++j) near_by[j] = c[j] + far_ * rate[j];
  range = sm_reach(now, now, drag_low, drag_high, heading, near_by, &course);
  holds = sm_pick(&range, &far_);
  if (holds) {
    for (j = 0; j < 3; ++j) near_by[j] = c[j] + far_ * rate[j];
    for (part = 0; part < 2; ++part) {
      const sm_real most = (part ? SM_C(0.25) : SM_C(1)) * far_;
      for (j = 0; j < 3; ++j) end[j] = now[j] + most * step[j];
      range = sm_reach(now, end, drag_low, drag_high, heading, near_by, &course);
      if (sm_pick(&range, &t)) { t = sm_least_of(t, most); break; }
      t = SM_C(0);
    }
  } else {
    t = far_;
  }
  for (j = 0; j < 3; ++j) next[j] = t == SM_C(1) ? target[j] : now[j] + t * step[j];
  return holds;
}

/* Three numbers cut to SM_LARGEST; all zero, and 0 returned, where one is not finite. */
static inline int sm_cleaned(sm_real *x) {
  const int fine = sm_is_number(x[0]) && sm_is_number(x[1]) && sm_is_number(x[2]);
  int j;
  for (j = 0; j < 3; ++j) x[j] = fine ? sm_between(x[j], -SM_LARGEST, SM_LARGEST) : SM_C(0);
  return fine;
}

static inline int sm_cleaned_heading(sm_real *heading) {
  const int fine = sm_is_number(*heading);
  *heading = fine ? sm_between(*heading, -SM_LARGEST, SM_LARGEST) : SM_C(0);
  return fine || !SM_FLOOR;
}

/* The next twist on the straight line from now to wanted, never past the margin.
   now: the twist commanded last; dt_s: time until the next command; heading_rad: yaw on the floor,
   which only a slope needs. */
static inline sm_code sm_limit_twist(sm_twist now, sm_twist wanted, sm_real dt_s, sm_real heading_rad,
                                     sm_twist *next) {
  sm_real v[3] = {now.vx_m_s, now.vy_m_s, now.wz_rad_s}, w[3], asked_for[3];
  sm_real out[3] = {SM_C(0), SM_C(0), SM_C(0)};
  const int faces = sm_cleaned_heading(&heading_rad), known = sm_cleaned(v);
  const int time_passes = sm_is_number(dt_s) && dt_s >= SM_C(1e-6);
  sm_code code;
  int j, asked;
  w[0] = wanted.vx_m_s;
  w[1] = wanted.vy_m_s;
  w[2] = wanted.wz_rad_s;
  asked = sm_cleaned(w);
  if (!(asked && faces && known)) for (j = 0; j < 3; ++j) w[j] = SM_C(0);
  for (j = 0; j < 3; ++j) asked_for[j] = w[j];
#if SM_TOP_SPEED
  {
    sm_real fastest = SM_FASTEST;
    for (j = 0; j < SM_WHEELS; ++j) fastest = sm_most_of(fastest, sm_size(sm_dot(sm_rolling[j], w)));
    for (j = 0; j < 3; ++j) w[j] *= SM_FASTEST / fastest;
  }
#endif
  if (!known) {
    code = SM_NO_INPUT;
  } else if (!time_passes) {
    for (j = 0; j < 3; ++j) out[j] = v[j];
    code = SM_NO_INPUT;
  } else {
    const sm_real rest[3] = {SM_C(0), SM_C(0), SM_C(0)}, dt = sm_least_of(dt_s, SM_LARGEST);
    sm_real low[SM_WHEELS], high[SM_WHEELS];
    sm_drag(v, low, high);
    if (sm_toward(v, low, high, w, dt, heading_rad, out))
      code = out[0] == asked_for[0] && out[1] == asked_for[1] && out[2] == asked_for[2] ? SM_REACHED : SM_CUT;
    else
      code = sm_toward(v, low, high, rest, dt, heading_rad, out) ? SM_BRAKED : SM_OVER;
    if (!(asked && faces)) code = SM_NO_INPUT;
  }
  next->vx_m_s = out[0];
  next->vy_m_s = out[1];
  next->wz_rad_s = out[2];
  return code;
}

/* A wanted acceleration cut back to the margin at a twist, its direction kept. */
static inline sm_code sm_limit_acceleration(sm_twist now, sm_real heading_rad, sm_acceleration wanted,
                                            sm_acceleration *allowed) {
  sm_real v[3] = {now.vx_m_s, now.vy_m_s, now.wz_rad_s};
  sm_real w[3] = {wanted.ax_m_s2, wanted.ay_m_s2, wanted.alpha_rad_s2};
  const int fine = sm_cleaned(v) & sm_cleaned(w) & sm_cleaned_heading(&heading_rad);
  sm_real near_by[3], low[SM_WHEELS], high[SM_WHEELS], t = SM_C(0);
  sm_course course;
  int j, round, holds = 0;
  sm_outwards(v, course.at);
  sm_to_centre(w, course.rate);
  sm_drag(v, low, high);
  course.turns = 0;
  course.gain0[0] = v[2] * v[1];
  course.gain0[1] = -v[2] * v[0];
  course.gain0[2] = SM_C(0);
  for (j = 0; j < 3; ++j) { near_by[j] = course.at[j]; course.gain[j] = w[j]; }
  for (round = 0; round < 1 + SM_SHARES_BY_LOAD; ++round) {
    const sm_range range = sm_reach(v, v, low, high, heading_rad, near_by, &course);
    holds = sm_pick(&range, &t);
    for (j = 0; j < 3; ++j) near_by[j] = course.at[j] + t * course.rate[j];
  }
  if (!fine) t = SM_C(0);
  allowed->ax_m_s2 = t * w[0];
  allowed->ay_m_s2 = t * w[1];
  allowed->alpha_rad_s2 = t * w[2];
  return !fine ? SM_NO_INPUT : (!holds ? SM_OVER : (t < SM_C(1) ? SM_CUT : SM_REACHED));
}

/* The share of its drive grip that the most loaded wheel uses at a twist and an acceleration; above 1 it
   slips.  wheel (may be 0): which one.  -1 where an input is no finite number. */
static inline sm_real sm_margin(sm_twist now, sm_acceleration acceleration, sm_real heading_rad, int *wheel) {
  sm_real v[3] = {now.vx_m_s, now.vy_m_s, now.wz_rad_s};
  sm_real w[3] = {acceleration.ax_m_s2, acceleration.ay_m_s2, acceleration.alpha_rad_s2};
  const int fine = sm_cleaned(v) & sm_cleaned(w) & sm_cleaned_heading(&heading_rad);
  sm_real c[3], a[3], low[SM_WHEELS], high[SM_WHEELS], left[SM_WHEELS], shift[SM_WHEELS];
  sm_real spread[SM_WHEELS][3], external[3], top = SM_C(-1);
  int i, j, which, worst = 0;
  sm_outwards(v, c);
  sm_to_centre(w, a);
  for (j = 0; j < 3; ++j) a[j] += c[j];
  sm_drag(v, low, high);
  for (i = 0; i < SM_WHEELS; ++i) {
    low[i] = SM_C(0.5) * (low[i] + high[i]);
    left[i] = sm_drive_left(i, sm_size(low[i]));
  }
  sm_external(v, heading_rad, external, shift);
  sm_sharing(left, shift, a, spread);
  for (which = 0; which < SM_CASES; ++which) {
    sm_real load[SM_WHEELS], wrench[3];
    for (j = 0; j < 3; ++j) wrench[j] = a[j] * sm_mass[j] - external[j];
    for (i = 0; i < SM_WHEELS; ++i) {
      load[i] = sm_rest[which][i] + shift[i];
#if SM_TRANSFERS
      load[i] += sm_moved(i, a);
#endif
      load[i] = sm_most_of(load[i], SM_LIGHTEST);
      for (j = 0; j < 3; ++j) wrench[j] += low[i] * load[i] * sm_across[i][j];
    }
    for (i = 0; i < SM_WHEELS; ++i) {
      const sm_real use = sm_size(sm_dot(spread[i], wrench)) / sm_most_of(left[i] * load[i], SM_C(1e-30));
      if (use > top) { top = use; worst = i; }
    }
  }
  if (wheel) *wheel = fine ? worst : -1;
  return fine ? top : SM_C(-1);
}
"""
