// SPDX-License-Identifier: BSD-3-Clause
// Links that come into force and are released during a run.

export class Switches {
  constructor(data) {
    this.data = data;
  }

  // Whether each link is in force at t.
  activeAt(t) {
    const active = [...this.data.switches.at_start];
    for (const s of this.data.switches.later) if (s.t <= t) active[s.link] = s.active;
    return active;
  }

  // Of each link at t: 'holds'; 'idle': it never held; 'off': it was switched off. Merged and one-sided ones always hold.
  statesAt(t) {
    const { links } = this.data.mechanism;
    const held = [...this.data.switches.at_start];
    for (const s of this.data.switches.later) if (s.t <= t && s.active) held[s.link] = true;
    const active = this.activeAt(t);
    return links.map((link, i) => {
      if (link.merged || link.one_sided || active[i]) return 'holds';
      return held[i] ? 'off' : 'idle';
    });
  }

  // When a link was last switched off until t, and by what; null: it was not.
  offAt(link, t) {
    const last = this.data.switches.later.filter((s) => s.link === link && s.t <= t).at(-1);
    if (!last || last.active) return null;
    const mark = this.data.marks.find((m) => m.t === last.t);
    return { t: last.t, what: mark ? mark.what : '' };
  }
}
