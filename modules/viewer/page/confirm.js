// SPDX-License-Identifier: BSD-3-Clause
// Asks before an action that this page cannot undo. Not modal, so that STOP can still be pressed.

let newest = null;  // the question that a click on Yes answers

/** Asks in `dialog`; if another question is still open there, that is answered by no. Returns a promise of whether the answer is yes. */
export function confirmed(dialog, question) {
  const mine = newest = {};
  dialog.querySelector("p").textContent = question;
  dialog.returnValue = "";
  dialog.show();
  dialog.querySelector("button[value=no]").focus();
  return new Promise((done) => dialog.addEventListener("close", () => done(newest === mine && dialog.returnValue === "yes"), {once: true}));
}
