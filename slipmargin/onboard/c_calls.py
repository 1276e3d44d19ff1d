"""The functions of the C header that a robot calls, and how far they go within the rows."""

from __future__ import annotations

#: The functions.
CALLS = """
/* Narrows [least, most], where row . (start + t slope) <= b. */
static inline void sm_narrow(sm_real room, sm_real rise, sm_real *least, sm_real *most) {
  if (rise > SM_C(0)) { if (room < *most * rise) *most = room / rise; }
  else if (rise < SM_C(0)) { if (room < *least * rise) *least = room / rise; }
  else if (room < SM_C(0)) *most = -SM_HUGE;
}

/* A row times an acceleration by turning, whose third part is zero. */
static inline sm_real sm_flat(const sm_row *row, const sm_real *x) {
  return row->a[0] * x[0] + row->a[1] * x[1];
}

/* Room of a row at an acceleration by turning, with the tolerance for rounding. */
static inline sm_real sm_room(const sm_row *row, const sm_real *turning) {
  return row->b - sm_flat(row, turning) + SM_ROUNDING * sm_size(row->b);
}

/* First t in [0, most] at which room - p t - q t^2 falls below zero, or most. */
static inline sm_real sm_first(sm_real room, sm_real p, sm_real q, sm_real most) {
  sm_real inside, below;
  if (room < SM_C(0) || room >= most * (sm_most_of(p, SM_C(0)) + sm_most_of(q, SM_C(0)) * most)) return most;
  inside = p * p + SM_C(4) * q * room;
  if (inside < SM_C(0)) return most;
  below = p + SM_SQRT(inside);
  return below > SM_C(0) ? sm_least_of(most, SM_C(2) * room / below) : most;
}

/* Greatest t in [0, 1] and [least, most]; 0 where there is none, and then the middle of the miss. */
static inline int sm_pick(sm_real least, sm_real most, sm_real *t) {
  const int holds = least <= most && least <= SM_C(1) && most >= SM_C(0);
  const sm_real up = sm_between(most, SM_C(0), SM_C(1));
  *t = holds ? up : SM_C(0.5) * (sm_between(least, SM_C(0), SM_C(1)) + up);
  return holds;
}

/* Acceleration of the centre of mass by turning at the twist v + t d: c + l t + s t^2. */
static inline void sm_turning(const sm_real *v, const sm_real *d, sm_real *c, sm_real *l, sm_real *s) {
  c[0] = -v[2] * v[1] - v[2] * v[2] * sm_com[0];
  c[1] = v[2] * v[0] - v[2] * v[2] * sm_com[1];
  l[0] = -(v[2] * d[1] + d[2] * v[1]) - SM_C(2) * v[2] * d[2] * sm_com[0];
  l[1] = v[2] * d[0] + d[2] * v[0] - SM_C(2) * v[2] * d[2] * sm_com[1];
  s[0] = -d[2] * d[1] - d[2] * d[2] * sm_com[0];
  s[1] = d[2] * d[0] - d[2] * d[2] * sm_com[1];
  c[2] = l[2] = s[2] = SM_C(0);
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

/* Greatest share t of a step within the rows: at its start, at its end, and steady from there on. */
static inline int sm_reach(const sm_row *rows, const sm_real *c, const sm_real *rate, const sm_real *l,
                           const sm_real *s, sm_real *t) {
  sm_real least = -SM_HUGE, most = SM_HUGE, ends = SM_C(1);
  int k, holds;
  for (k = 0; k < SM_ROWS; ++k) {
    const sm_real room = sm_room(rows + k, c), rise = sm_dot(rows[k].a, rate);
    const sm_real p = sm_flat(rows + k, l), q = sm_flat(rows + k, s);
    sm_narrow(room, rise, &least, &most);
    ends = sm_first(room, rise + p, q, ends);
    ends = sm_first(room, p, q, ends);
  }
  holds = sm_pick(least, most, t);
  if (holds) *t = sm_least_of(*t, sm_most_of(ends, sm_most_of(least, SM_C(0))));
  return holds;
}

/* One step from now towards a target; 0 where no part of it keeps the margin. */
static inline int sm_toward(const sm_real *now, const sm_real *drag_low, const sm_real *drag_high,
                            const sm_real *target, sm_real dt, sm_real heading, sm_real *next) {
  sm_real step[3], per_s[3], rate[3], c[3], l[3], s[3], near_by[3], end[3], far_, t = SM_C(0);
  sm_row rows[SM_ROWS];
  int j, part, holds;
  for (j = 0; j < 3; ++j) { step[j] = target[j] - now[j]; per_s[j] = step[j] / dt; }
  sm_turning(now, step, c, l, s);
  sm_to_centre(per_s, rate);
  far_ = SM_PULL / sm_most_of(SM_SQRT(rate[0] * rate[0] + rate[1] * rate[1]), SM_PULL);
  for (j = 0; j < 3; ++j) near_by[j] = c[j] + far_ * rate[j];
  sm_rows(now, now, drag_low, drag_high, heading, near_by, rows);
  holds = sm_reach(rows, c, rate, l, s, &far_);
  if (holds) {
    for (j = 0; j < 3; ++j) near_by[j] = c[j] + far_ * rate[j];
    for (part = 0; part < 2; ++part) {
      const sm_real most = (part ? SM_C(0.25) : SM_C(1)) * far_;
      for (j = 0; j < 3; ++j) end[j] = now[j] + most * step[j];
      sm_rows(now, end, drag_low, drag_high, heading, near_by, rows);
      if (sm_reach(rows, c, rate, l, s, &t)) { t = sm_least_of(t, most); break; }
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
  sm_real v[3] = {now.vx_m_s, now.vy_m_s, now.wz_rad_s}, w[3];
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
      code = out[0] == w[0] && out[1] == w[1] && out[2] == w[2] ? SM_REACHED : SM_CUT;
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
  sm_real c[3], slope[3], near_by[3], low[SM_WHEELS], high[SM_WHEELS], t = SM_C(0);
  sm_row rows[SM_ROWS];
  int j, k, round, holds = 0;
  sm_outwards(v, c);
  sm_to_centre(w, slope);
  sm_drag(v, low, high);
  for (j = 0; j < 3; ++j) near_by[j] = c[j];
  for (round = 0; round < 1 + SM_SHARES_BY_LOAD; ++round) {
    sm_real least = -SM_HUGE, most = SM_HUGE;
    sm_rows(v, v, low, high, heading_rad, near_by, rows);
    for (k = 0; k < SM_ROWS; ++k)
      sm_narrow(sm_room(rows + k, c), sm_dot(rows[k].a, slope), &least, &most);
    holds = sm_pick(least, most, &t);
    for (j = 0; j < 3; ++j) near_by[j] = c[j] + t * slope[j];
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
      load[i] += sm_transfer[i][0] * a[0] + sm_transfer[i][1] * a[1];
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
