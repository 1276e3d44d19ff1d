"""The part of the C header that is the same for every robot; tables and switches stand above it."""

from __future__ import annotations

#: Friction, external forces, and the rows that limit an acceleration.
ROWS = """
/* A number that depends on the acceleration of the centre of mass, along a step of which a share t is done:
   at + t rate at its start, at + t (rate + turn) + t^2 curl at its end, at + t turn + t^2 curl in steady
   motion from there on. */
typedef struct { sm_real at, rate, turn, curl; } sm_parts;
/* The acceleration itself along the step, and gain0 + t gain, how fast the twist changes; whether it turns:
   else turn and curl are not looked at. */
typedef struct { sm_real at[3], rate[3], turn[3], curl[3], gain0[3], gain[3]; int turns; } sm_course;
/* Which shares of a step are left: from least to most at its start, up to ends afterwards. */
typedef struct { sm_real least, most, ends; } sm_range;

static inline sm_real sm_least_of(sm_real x, sm_real y) { return x < y ? x : y; }
static inline sm_real sm_most_of(sm_real x, sm_real y) { return x > y ? x : y; }
static inline sm_real sm_size(sm_real x) { return sm_most_of(x, -x); }
static inline sm_real sm_between(sm_real x, sm_real low, sm_real high) {
  return x < low ? low : (x > high ? high : x);
}
static inline int sm_is_number(sm_real x) { return x - x == SM_C(0); }
static inline sm_real sm_dot(const sm_real *x, const sm_real *y) {
  return x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
}

/* Share of its grip that a contact uses at z = k u. */
static inline sm_real sm_friction(sm_real z) {
#if SM_LAW == 0 /* (2/pi) atan z: 1/z where z is large, the angle halved, then a polynomial up to tan(pi/8) */
  const sm_real size = sm_size(z), whole = sm_between(z, -SM_C(1), SM_C(1));
  sm_real x = whole / sm_most_of(size, SM_C(1)), x2, series;
  x = x / (SM_C(1) + SM_SQRT(SM_C(1) + x * x));
  x2 = x * x;
#if SM_SINGLE /* off by at most 2.3e-9 of the angle */
  series = -SM_C(0.1426395559798464) + x2 * (SM_C(0.10743731490791084) - x2 * SM_C(0.06451928208121749));
  series = -SM_C(0.3333333176116852) + x2 * (SM_C(0.19999540483648964) + x2 * series);
#else /* off by at most 1.4e-16 */
  series = -SM_C(0.04483334622272886) + x2 * SM_C(0.022750526993361674);
  series = -SM_C(0.06649613695291669) + x2 * (SM_C(0.05736332165907643) + x2 * series);
  series = -SM_C(0.09090852557176049) + x2 * (SM_C(0.0769105515839315) + x2 * series);
  series = -SM_C(0.1428571426609662) + x2 * (SM_C(0.11111109636534361) + x2 * series);
  series = -SM_C(0.3333333333333325) + x2 * (SM_C(0.19999999999898407) + x2 * series);
#endif
  x = SM_C(2) * (x + x * x2 * series) * SM_C(0.63661977236758134308);
  return size > SM_C(1) ? whole - x : x;
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

/* Drag per load of wheel i that slips across alone; which: the least or the greatest. */
static inline sm_real sm_alone(int which, int i, sm_real slide) {
#if SM_COUPLED
  const sm_real most = sm_transverse[which][i];
  const sm_real one = sm_coupled_drag[which][i] * sm_friction(sm_coupled_slope[which][i] * slide);
#if SM_PARTLY
  return (SM_C(1) - SM_COUPLING) * most * sm_friction(sm_slope[which][i] * slide)
         + SM_COUPLING * sm_between(one, -most, most);
#else
  return sm_between(one, -most, most);
#endif
#else
  return sm_transverse[which][i] * sm_friction(sm_slope[which][i] * slide);
#endif
}

/* Least and greatest drag per load at a twist. */
static inline void sm_drag(const sm_real *twist, sm_real *low, sm_real *high) {
  int i;
  for (i = 0; i < SM_WHEELS; ++i) {
    const sm_real slide = sm_dot(sm_lateral[i], twist);
#if SM_EXACT_DRAG
    low[i] = high[i] = sm_alone(1, i, slide);
#else
    const sm_real less = sm_alone(0, i, slide), more = sm_alone(1, i, slide);
    low[i] = sm_least_of(less, more);
    high[i] = sm_most_of(less, more);
#endif
  }
}

/* Drive coefficient of wheel i that a drag leaves. */
static inline sm_real sm_drive_left(int i, sm_real drag) {
#if SM_COUPLED
  const sm_real whole = sm_most_beside[i];
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
    sm_real moment[2];
    s = SM_C(1) / SM_C(120) + x2 * (-SM_C(1) / SM_C(5040) + x2 * (s + x2 * x2 / SM_C(6227020800.0)));
    s = x * (SM_C(1) + x2 * (-SM_C(1) / SM_C(6) + x2 * s));
    c = SM_C(1) / SM_C(24) + x2 * (-SM_C(1) / SM_C(720) + x2 * c);
    c = SM_C(1) + x2 * (-SM_C(0.5) + x2 * c);
    for (i = 0; i < 3; ++i) { /* three doublings */
      const sm_real s2 = SM_C(2) * s * c;
      c = SM_C(1) - SM_C(2) * s * s;
      s = s2;
    }
    wrench[0] += c * sm_floor[0] + s * sm_floor[1];
    wrench[1] += c * sm_floor[1] - s * sm_floor[0];
    wrench[2] += sm_floor[2];
    moment[0] = c * sm_floor_moment[0] + s * sm_floor_moment[1];
    moment[1] = c * sm_floor_moment[1] - s * sm_floor_moment[0];
    for (i = 0; i < SM_WHEELS; ++i)
      shift[i] = sm_floor_loads[i][0] * moment[0] + sm_floor_loads[i][1] * moment[1];
  }
#else
  (void)heading;
#endif
}

#if SM_TRANSFERS
/* What an acceleration adds to the load of wheel i. */
static inline sm_real sm_moved(int i, const sm_real *acceleration) {
  return sm_transfer[i][0] * acceleration[0] + sm_transfer[i][1] * acceleration[1];
}
#endif

/* How the wheels share a wrench: a table, or by their grip at the acceleration near_by.  Then it is the mean
   of what every three wheels would do alone, weighted by the product of their grips: nothing cancels. */
static inline void sm_sharing(const sm_real *left, const sm_real *shift, const sm_real *near_by,
                              sm_real spread[SM_WHEELS][3]) {
  int i, j;
#if SM_SHARES_BY_LOAD
  sm_real grip[SM_WHEELS], all = SM_C(0);
  int k;
  for (i = 0; i < SM_WHEELS; ++i) {
    const sm_real moved = sm_moved(i, near_by);
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

/* First t in [0, most] at which room - p t - q t^2 falls below zero, or most. */
static inline sm_real sm_first(sm_real room, sm_real p, sm_real q, sm_real most) {
  sm_real inside, below;
  if (room >= most * (p + sm_size(q) * most)) return most;
  inside = p * p + SM_C(4) * q * room;
  if (inside < SM_C(0)) return most;
  below = p + SM_SQRT(inside);
  return below > SM_C(0) ? sm_least_of(most, SM_C(2) * room / below) : most;
}

/* Narrows a range by a row of which there is room at the start; one that fails there already says nothing of
   the end of the step. */
static inline void sm_row(sm_range *range, int turns, sm_real room, sm_real rate, sm_real turn,
                          sm_real curl) {
  const sm_real none = SM_C(0);
  if (room < none) {
    if (rate >= none) range->most = -SM_HUGE;
    else if (room < range->least * rate) range->least = room / rate;
    return;
  }
  if (room < range->most * rate) range->most = room / rate;
  if (turns) {
    range->ends = sm_first(room, rate + turn, curl, sm_least_of(range->ends, range->most));
    range->ends = sm_first(room, turn, curl, range->ends);
  }
}

/* Two rows: force with either sign <= grip, and what there is more of with one sign. */
static inline void sm_pair(sm_range *range, int turns, const sm_parts *force, const sm_parts *grip,
                           sm_real plus, sm_real minus) {
  sm_row(range, turns, grip->at - force->at + plus, force->rate - grip->rate, force->turn - grip->turn,
         force->curl - grip->curl);
  sm_row(range, turns, grip->at + force->at + minus, -force->rate - grip->rate, -force->turn - grip->turn,
         -force->curl - grip->curl);
}

/* Adds a part of a load. */
static inline void sm_add_load(sm_parts *sum, int turns, sm_real part, const sm_parts *load) {
  sum->at += part * load->at;
#if SM_TRANSFERS
  sum->rate += part * load->rate;
  if (turns) {
    sum->turn += part * load->turn;
    sum->curl += part * load->curl;
  }
#else
  (void)turns;
#endif
}

/* The force of a wheel out of the three parts of a wrench. */
static inline sm_parts sm_force(const sm_real *s, int turns, const sm_parts *push) {
  sm_parts force = {SM_C(0), SM_C(0), SM_C(0), SM_C(0)};
  force.at = s[0] * push[0].at + s[1] * push[1].at + s[2] * push[2].at;
  force.rate = s[0] * push[0].rate + s[1] * push[1].rate + s[2] * push[2].rate;
  if (turns) {
    force.turn = s[0] * push[0].turn + s[1] * push[1].turn + s[2] * push[2].turn;
    force.curl = s[0] * push[0].curl + s[1] * push[1].curl + s[2] * push[2].curl;
  }
  return force;
}

#if SM_MOTOR
/* Parts times a number. */
static inline sm_parts sm_scaled(const sm_parts *x, sm_real by) {
  sm_parts out;
  out.at = x->at * by;
  out.rate = x->rate * by;
  out.turn = x->turn * by;
  out.curl = x->curl * by;
  return out;
}
#endif

#if !SM_EXACT_REST
/* What loads that are known within a band only take from a row; part: force per drag of each wheel. */
static inline sm_real sm_band(sm_real sign, const sm_real *part, const sm_real *mid, const sm_real *half,
                              int which, int own, sm_real grip) {
  sm_real takes = SM_C(0);
  int j;
  for (j = 0; j < SM_WHEELS; ++j) {
    const sm_real worst = sm_size(part[j]) * half[j] - (j == own ? grip : SM_C(0));
    takes += sm_size(worst + sign * part[j] * mid[j]) * sm_rest_half[which][j];
  }
  return takes;
}
#endif

/* What the rows leave of a course while the twist goes from start, whose drag is known, to end.
   The drag per load of wheel j lies within mid +- half; cross = spread . across is its part of a force:
   |spread . (M a - w + across mid N(a))| + |cross| half N(a) <= share left N(a). */
static inline sm_range sm_reach(const sm_real *start, const sm_real *end, const sm_real *drag_low,
                                const sm_real *drag_high, sm_real heading, const sm_real *near_by,
                                const sm_course *course) {
  const int wide = start != end || !SM_EXACT_DRAG, turns = course->turns;
  const sm_parts nothing = {SM_C(0), SM_C(0), SM_C(0), SM_C(0)};
  sm_range range = {SM_C(0), SM_C(1), SM_C(1)};
  sm_real mid[SM_WHEELS], half[SM_WHEELS], left[SM_WHEELS], shift[SM_WHEELS], spread[SM_WHEELS][3];
  sm_real external[3];
  int i, j, k, which;
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
    sm_parts load[SM_WHEELS], push[3];
    for (j = 0; j < SM_WHEELS; ++j) {
      load[j] = nothing;
      load[j].at = sm_rest[which][j] + shift[j];
#if SM_TRANSFERS
      load[j].at += sm_moved(j, course->at);
      load[j].rate = sm_moved(j, course->rate);
      if (turns) {
        load[j].turn = sm_moved(j, course->turn);
        load[j].curl = sm_moved(j, course->curl);
      }
      if (which == 0) {
        const sm_real room = SM_SLACK * (sm_least_rest(0, j) + shift[j]) + sm_moved(j, course->at);
        sm_row(&range, turns, room, -load[j].rate, -load[j].turn, -load[j].curl);
      }
#endif
    }
    for (k = 0; k < 3; ++k) {
      push[k] = nothing;
      push[k].at = sm_mass[k] * course->at[k] - external[k];
      push[k].rate = sm_mass[k] * course->rate[k];
      if (turns) {
        push[k].turn = sm_mass[k] * course->turn[k];
        push[k].curl = sm_mass[k] * course->curl[k];
      }
      for (j = 0; j < SM_WHEELS; ++j) sm_add_load(push + k, turns, sm_across[j][k] * mid[j], load + j);
    }
    for (i = 0; i < SM_WHEELS; ++i) {
      const sm_real *s = spread[i], grip = SM_SHARE * left[i];
      const sm_real rest = grip * (sm_rest[which][i] + shift[i]), still = sm_dot(s, external);
      sm_parts force = sm_force(s, turns, push), room = nothing, bound;
      sm_real plus = (SM_SLACK / SM_SHARE - SM_C(1)) * sm_size(rest + still);
      sm_real minus = (SM_SLACK / SM_SHARE - SM_C(1)) * sm_size(rest - still);
#if SM_MOTOR || !SM_EXACT_REST
      const sm_real own = sm_dot(s, sm_across[i]);
#endif
      if (wide)
        for (j = 0; j < SM_WHEELS; ++j)
          sm_add_load(&room, turns, -sm_size(sm_dot(s, sm_across[j])) * half[j], load + j);
#if !SM_EXACT_WRENCH
      for (k = 0; k < 3; ++k) room.at -= sm_size(s[k]) * sm_wrench_half[k];
#endif
#if !SM_EXACT_REST
      {
        sm_real cross[SM_WHEELS];
        for (j = 0; j < SM_WHEELS; ++j) cross[j] = sm_dot(s, sm_across[j]);
        plus -= sm_band(SM_C(1), cross, mid, half, which, i, grip);
        minus -= sm_band(-SM_C(1), cross, mid, half, which, i, grip);
      }
#endif
      bound = room;
      sm_add_load(&bound, turns, grip, load + i);
      sm_pair(&range, turns, &force, &bound, plus, minus);
#if SM_MOTOR
      {
        const sm_real arm = sm_torque_force[i], size = sm_size(arm), direct = sm_torque_drag[i];
        const sm_real more = (SM_SLACK - SM_SHARE) * SM_STALL;
        plus = SM_SHARE * sm_torque(i, SM_C(1), start, end) + more;
        minus = SM_SHARE * sm_torque(i, SM_C(-1), start, end) + more;
        force = sm_scaled(&force, arm);
        room = sm_scaled(&room, size);
        sm_add_load(&force, turns, direct * mid[i], load + i);
#if SM_SPIN
        force.at += sm_dot(sm_spin[i], course->gain0);
        force.rate += sm_dot(sm_spin[i], course->gain);
#endif
        if (wide)
          sm_add_load(&room, turns, (size * sm_size(own) - sm_size(arm * own + direct)) * half[i], load + i);
#if !SM_EXACT_REST
        {
          sm_real cross[SM_WHEELS];
          for (j = 0; j < SM_WHEELS; ++j)
            cross[j] = arm * sm_dot(s, sm_across[j]) + (i == j ? direct : SM_C(0));
          plus -= sm_band(SM_C(1), cross, mid, half, which, -1, SM_C(0));
          minus -= sm_band(-SM_C(1), cross, mid, half, which, -1, SM_C(0));
        }
#endif
        sm_pair(&range, turns, &force, &room, plus, minus);
      }
#endif
    }
  }
  return range;
}
"""
