'use strict';

// The numbers of a plot: those of the mark nearest to the mouse or finger.
for (const picture of document.querySelectorAll('.picture')) {
  const marks = [...picture.querySelectorAll('[data-tip]')];
  // The browser's own late bubbles would come on top of these.
  const image = picture.querySelector('svg'), title = picture.querySelector('title');
  if (title) image.setAttribute('aria-label', title.textContent);
  picture.querySelectorAll('title').forEach((bubble) => bubble.remove());
  const tip = document.createElement('div');
  tip.className = 'tip';
  let lit = null;

  function light(mark) {
    if (lit) lit.classList.remove('lit');
    if (mark) mark.classList.add('lit');
    else
      tip.remove();
    lit = mark;
  }

  function nearest(event) {
    let best = null, least = 40;
    for (const mark of marks) {
      const box = mark.getBoundingClientRect();
      const x = Math.max(box.left - event.clientX, event.clientX - box.right, 0);
      const y = Math.max(box.top - event.clientY, event.clientY - box.bottom, 0);
      const away = Math.hypot(x, y) + (x + y ? 0 : -1);
      if (away < least) [best, least] = [mark, away];
    }
    return best;
  }

  function tell(event) {
    const mark = nearest(event);
    light(mark);
    if (!mark) return;
    tip.textContent = mark.dataset.tip;
    picture.append(tip);
    const box = mark.getBoundingClientRect(), frame = picture.getBoundingClientRect();
    const x = (box.left + box.right - tip.offsetWidth) / 2 - frame.left;
    const inside = Math.min(Math.max(x, 4), frame.width - tip.offsetWidth - 4);
    tip.style.left = inside + 'px';
    const above = box.top - frame.top - tip.offsetHeight - 8;
    tip.style.top = (above > 0 ? above : box.bottom - frame.top + 8) + 'px';
  }
  picture.addEventListener('pointermove', tell);
  picture.addEventListener('pointerdown', tell);
  // A finger that is lifted leaves its numbers to be read, until the next touch.
  picture.addEventListener('pointerleave', (event) => event.pointerType === 'touch' || light(null));
  document.addEventListener('pointerdown', (event) => picture.contains(event.target) || light(null));
}
