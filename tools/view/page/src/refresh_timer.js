// Common refresh timer: text, charts and the clock change together, five times per second (a beat).
// Between beats only the stage changes. A browser composites the bounding box of all changes again;
// between beats this box is usually only the stage.

export const kRefreshPeriod_ms = 200;

const calls = [];
let count = 0;

/** Calls `write` with the number of the beat every `beats` beats while the page is visible. */
export function on_refresh(write, beats = 1) {
  calls.push({ write, beats });
}

setInterval(() => {
  if (document.hidden) return;
  requestAnimationFrame(() => {
    count += 1;
    for (const { write, beats } of calls) {
      if (count % beats === 0) write(count);
    }
  });
}, kRefreshPeriod_ms);
