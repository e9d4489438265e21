(function () {
  "use strict";
  var table = document.querySelector("table.shots");
  if (!table) return;
  document.documentElement.classList.add("js");
  var body = table.tBodies[0], heads = Array.from(table.tHead.rows[0].cells);
  var collator = new Intl.Collator(undefined, {numeric: true});

  function keyOf(row, column) {
    var cell = row.cells[column];
    return cell.dataset.value === undefined ? cell.textContent : cell.dataset.value;
  }

  // Rows without a number go to the end either way.
  function sort(column, sign) {
    var numeric = heads[column].classList.contains("n");
    var rows = Array.from(body.rows);
    rows.sort(function (a, b) {
      var x = keyOf(a, column), y = keyOf(b, column);
      if (!numeric) return sign * collator.compare(x, y);
      if (x === "" || y === "") return (x === "" ? 1 : 0) - (y === "" ? 1 : 0);
      return sign * (Number(x) - Number(y));
    });
    rows.forEach(function (row) { body.appendChild(row); });
  }

  heads.forEach(function (head, column) {
    var button = document.createElement("button");
    while (head.firstChild) button.appendChild(head.firstChild);
    button.type = "button";
    head.appendChild(button);
    button.addEventListener("click", function () {
      var sign = head.getAttribute("aria-sort") === "ascending" ? -1 : 1;
      heads.forEach(function (other) { other.removeAttribute("aria-sort"); });
      head.setAttribute("aria-sort", sign > 0 ? "ascending" : "descending");
      sort(column, sign);
    });
  });

  var wanted = document.querySelector(".filter input");
  wanted.addEventListener("input", function () {
    var text = wanted.value.toLowerCase();
    Array.from(body.rows).forEach(function (row) {
      row.hidden = row.textContent.toLowerCase().indexOf(text) < 0;
    });
  });
})();
