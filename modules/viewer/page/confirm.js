// SPDX-License-Identifier: BSD-3-Clause
// A question before what cannot be taken back from this page. Not modal: STOP can be pressed beside it.

/** Asks in `dialog`; a promise of whether the answer is yes. */
export function confirmed(dialog, question) {
  dialog.querySelector("p").textContent = question;
  dialog.returnValue = "";
  dialog.show();
  dialog.querySelector("button[value=no]").focus();
  return new Promise((done) => dialog.addEventListener("close", () => done(dialog.returnValue === "yes"), {once: true}));
}
