// SPDX-License-Identifier: BSD-3-Clause
// Links that come into force and are released during a run.

export class Switches {
  constructor(data) {
    this.data = data;
  }

  // Of each joint at t: 'holds'; 'idle': it never held; 'off': it was deactivated. Merged and one-sided ones always hold.
  statesAt(t) {
    const { at_start: atStart, later } = this.data.switches;
    const active = [...atStart],
      held = [...atStart];
    for (const s of later) {
      if (s.t > t) continue;
      active[s.link] = s.active;
      held[s.link] ||= s.active;
    }
    return this.data.mechanism.links.map((link, i) => {
      if (link.merged || link.one_sided || active[i]) return 'holds';
      return held[i] ? 'off' : 'idle';
    });
  }

  // When a joint was last deactivated until t, and by what; null: it was not.
  offAt(link, t) {
    const last = this.data.switches.later.filter((s) => s.link === link && s.t <= t).at(-1);
    if (!last || last.active) return null;
    const mark = this.data.marks.find((m) => m.t === last.t);
    return { t: last.t, what: mark ? mark.what : '' };
  }
}
