// The table of submissions is sorted by a click on a heading.
for (const table of document.querySelectorAll("table.submissions")) {
  const heads = [...table.tHead.rows[0].cells];
  const body = table.tBodies[0];
  const text = (row, column) => row.cells[column].textContent.trim();
  const number = (value) => parseFloat(value.replace("\u2212", "-"));
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const down = head.getAttribute("aria-sort") === "ascending";
      heads.forEach((other) => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", down ? "descending" : "ascending");
      const numbers = head.classList.contains("number");
      const order = (a, b) => {
        const [x, y] = [text(a, column), text(b, column)];
        const by = numbers ? number(x) - number(y) : x.localeCompare(y, undefined, { numeric: true });
        return down ? -by : by;
      };
      body.append(...[...body.rows].sort(order));
    });
  });
}
