// Named layouts, stored in this browser. A layout is the content of a link without log and time.

import { make } from "./panels.js";

const kKept = "vantage.layouts";

function kept() {
  try {
    const found = JSON.parse(localStorage.getItem(kKept) ?? "{}");
    return Object.fromEntries(Object.entries(found).filter(([, text]) => typeof text === "string"));
  } catch {
    return {}; // invalid content, or the storage is not permitted
  }
}

export class Layouts {
  /** @param on {take(): returns the current layout as text, give(text): applies a layout, failed(words): reports an error} */
  constructor(dialog, on) {
    this.dialog = dialog;
    this.on = on;
    const form = make("form");
    this.name = make("input");
    this.name.placeholder = "name for the present layout";
    this.name.setAttribute("aria-label", "Name of the layout");
    this.name.maxLength = 60;
    const save = make("button", "", "Save");
    form.append(this.name, save);
    form.onsubmit = (event) => {
      event.preventDefault();
      if (this.name.value.trim() === "") return;
      this.keep({ ...kept(), [this.name.value.trim()]: on.take() });
      this.name.value = "";
    };
    this.list = make("ul");
    const close = make("button", "", "Close");
    close.onclick = () => dialog.close();
    dialog.append(make("h2", "", "Layouts"), this.list, form, close);
  }

  open() {
    this.write();
    this.dialog.showModal();
    this.name.focus();
  }

  keep(layouts) {
    try {
      localStorage.setItem(kKept, JSON.stringify(layouts));
    } catch {
      this.on.failed("layouts cannot be saved: this browser blocks local storage");
    }
    this.write();
  }

  write() {
    const layouts = kept();
    const names = Object.keys(layouts).sort();
    this.list.replaceChildren(...names.map((name) => {
      const row = make("li", "line");
      const give = make("button", "", name);
      give.dataset.layout = name;
      give.onclick = () => {
        this.dialog.close();
        this.on.give(layouts[name]);
      };
      const forget = make("button", "", "×");
      forget.setAttribute("aria-label", `Forget ${name}`);
      forget.onclick = () => this.keep(Object.fromEntries(Object.entries(layouts).filter(([each]) => each !== name)));
      row.append(give, make("span", "space"), forget);
      return row;
    }));
    if (names.length === 0) this.list.replaceChildren(make("li", "quiet", "No layouts yet. A layout saves the charts, cameras, layers and side panel under a name."));
  }
}
