// SPDX-License-Identifier: BSD-3-Clause
// Asks before an action that this page cannot undo. Not modal, so that STOP can still be pressed.

/** Asks in `dialog`; returns a promise of whether the answer is yes. */
export function confirmed(dialog, question) {
  dialog.querySelector("p").textContent = question;
  dialog.returnValue = "";
  dialog.show();
  dialog.querySelector("button[value=no]").focus();
  return new Promise((done) => dialog.addEventListener("close", () => done(dialog.returnValue === "yes"), {once: true}));
}
