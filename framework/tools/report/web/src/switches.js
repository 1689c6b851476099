// SPDX-License-Identifier: BSD-3-Clause
// Links that come into force and are released during a run.

// Of each joint at t: 'holds'; 'idle': it never held; 'off': it was deactivated. Merged and one-sided ones always hold.
export function statesAt({ switches, mechanism }, t) {
  const active = [...switches.at_start],
    held = [...switches.at_start];
  for (const s of switches.later) {
    if (s.t > t) continue;
    active[s.link] = s.active;
    held[s.link] ||= s.active;
  }
  return mechanism.links.map((link, i) => {
    if (link.merged || link.one_sided || active[i]) return 'holds';
    return held[i] ? 'off' : 'idle';
  });
}

// When a joint was last deactivated until t, and by what; null: it was not.
export function offAt({ switches, marks }, link, t) {
  const last = switches.later.filter((s) => s.link === link && s.t <= t).at(-1);
  if (!last || last.active) return null;
  const mark = marks.find((m) => m.t === last.t);
  return { t: last.t, what: mark ? mark.what : '' };
}
