// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/result.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <lockstep/text.h>
#include "framework/foundation/support/csv_cells.h"
#include "framework/foundation/support/lines.h"
#include "framework/tools/program/findings.h"
#include "framework/tools/program/growing_file.h"
#include "framework/tools/program/terminal.h"
#include "framework/tools/rank/doubts.h"

namespace lockstep {
namespace {

constexpr std::size_t kMostLines = 40;  // of a list, as text

bool is_rounding(const Json& x, double largest) {
  return x.is_number_float() && (std::abs(x.get<double>()) <= 1e-12 * largest || std::abs(x.get<double>()) < 1e-30);
}

// The largest number in it, however deep.
double largest_in(const Json& v) {
  if (v.is_number()) return std::abs(v.get<double>());
  double largest = 0;
  if (v.is_array())
    for (const Json& x : v) largest = std::max(largest, largest_in(x));
  return largest;
}

// A value in one line, without its unit; `largest`: the largest number of this unit that is printed.
std::string value_text(const FieldInfo& field, const Json& v, double largest) {
  if (field.words != nullptr) return field.words(v);
  if (v.is_string()) return v;
  if (v.is_boolean()) return v.get<bool>() ? "yes" : "no";
  if (!v.is_array()) return v.is_number() || v.is_null() ? number_text(v, largest) : v.dump();
  if (field.type != "string") return vector_text(v, largest);
  std::vector<std::string> names;
  for (const Json& each : v)
    names.push_back(each.is_array() ? text::join(each.get<std::vector<std::string>>(), ", ") : each.get<std::string>());
  return first_of(names);
}

std::string with_unit(const FieldInfo& field, const Json& v, double largest) {
  const std::string text = value_text(field, v, largest);
  return text.empty() || field.unit.empty() || v.is_null() || field.words != nullptr ? text : text + " " + field.unit;
}

// A sentence a line.
bool is_sentences(const FieldInfo& field, const Json& v) {
  return field.type == "string" && v.is_array() && std::ranges::any_of(v, [](const Json& each) {
           return each.is_string() && each.get_ref<const std::string&>().find(' ') != std::string::npos;
         });
}

class Printer {
 public:
  Printer(std::string& out, const Schema& schema, const Json& data) : out_(out) { measure(schema, data); }

  void fields(const Schema& schema, const Json& data, std::size_t indent) {
    std::size_t width = 0;
    for (const FieldInfo& f : schema.fields)
      if ((f.of == nullptr || f.words != nullptr) && is_shown(f, data)) width = std::max(width, f.label.size());
    for (const FieldInfo& f : schema.fields) {
      if (!is_shown(f, data)) continue;
      const Json& v = data[f.name];
      if (f.words != nullptr || (f.of == nullptr && !is_sentences(f, v))) {
        const Json& shown = f.of != nullptr ? rounded(*f.of, v) : v;
        line(indent, fmt::format("{:<{}}  {}", f.label, width, with_unit(f, shown, largest_[unit_of(f, data)])));
      } else if (f.of == nullptr)
        sentences(f, v, indent, width);
      else
        objects(f, v, indent);
    }
  }

 private:
  // Its own, or that which its object names.
  static std::string unit_of(const FieldInfo& f, const Json& object) {
    return f.unit.empty() ? object.value("unit", "") : f.unit;
  }
  // The largest number of each unit: next to it, rounding is printed as 0.
  void measure(const Schema& schema, const Json& data) {
    for (const FieldInfo& f : schema.fields) {
      if (f.label.empty() || !data.contains(f.name)) continue;
      const Json& v = data[f.name];
      if (f.of == nullptr) {
        double& largest = largest_[unit_of(f, data)];
        largest = std::max(largest, largest_in(v));
      } else if (f.depth == 0 && !f.by_name) {
        if (v.is_object()) measure(*f.of, v);
      } else {
        for (const Json& each : v) measure(*f.of, each);
      }
    }
  }
  // An object that is printed by words, without rounding.
  Json rounded(const Schema& schema, Json object) {
    for (const FieldInfo& f : schema.fields)
      if (object.contains(f.name) && object[f.name].is_array())
        for (Json& x : object[f.name])
          if (is_rounding(x, largest_[f.unit])) x = 0.0;
    return object;
  }
  static bool is_shown(const FieldInfo& f, const Json& data) {
    if (f.label.empty() || !data.contains(f.name)) return false;
    const Json& v = data[f.name];
    return f.words == nullptr ? !is_empty(v) : (v.is_boolean() || !is_empty(v)) && !f.words(v).empty();
  }
  static std::size_t most(const FieldInfo& f) { return f.whole ? std::string::npos : kMostLines; }
  // Further lines of the text are indented more.
  void line(std::size_t indent, const std::string& text) {
    std::size_t more = indent;
    for (const std::string& each : lines_of(text)) {
      out_ += std::string(more, ' ') + each.substr(0, each.find_last_not_of(' ') + 1) + "\n";
      more = indent + 2;
    }
  }
  void rest(const FieldInfo& f, std::size_t n, std::size_t indent) {
    if (n > most(f)) line(indent, fmt::format("and {} more (--json)", n - kMostLines));
  }

  void sentences(const FieldInfo& f, const Json& v, std::size_t indent, std::size_t width) {
    for (std::size_t k = 0; k < std::min(v.size(), most(f)); ++k)
      line(indent, fmt::format("{:<{}}  {}", k == 0 ? f.label : "", width, v[k].get<std::string>()));
    rest(f, v.size(), indent + width + 2);
  }

  // An object, a table of objects, or one after another if they hold objects themselves.
  void objects(const FieldInfo& f, const Json& v, std::size_t indent) {
    const bool single = f.depth == 0 && !f.by_name;
    const bool flat = std::ranges::none_of(
        f.of->fields, [](const FieldInfo& g) { return g.of != nullptr && !g.label.empty() && g.words == nullptr; });
    if (!single && flat) return table(f, v, indent);
    if (single) {
      line(indent, fmt::format("{}:", f.label));
      return fields(*f.of, v, indent + 2);
    }
    std::size_t k = 0;
    for (const auto& [name, each] : v.items()) {
      if (k++ == most(f)) break;
      line(indent, f.by_name ? fmt::format("{} '{}':", f.label, name) : fmt::format("{} {}:", f.label, k));
      fields(*f.of, each, indent + 2);
    }
    rest(f, v.size(), indent);
  }

  // A line for each, below the labels of their fields.
  void table(const FieldInfo& f, const Json& v, std::size_t indent) {
    std::vector<const FieldInfo*> shown;
    std::vector<std::vector<std::string>> rows(1);
    if (f.by_name) rows[0].emplace_back("name");
    for (const FieldInfo& g : f.of->fields) {
      if (std::ranges::none_of(v, [&](const Json& each) { return is_shown(g, each); })) continue;
      shown.push_back(&g);
      rows[0].push_back(g.label + (g.unit.empty() || g.words != nullptr ? "" : " [" + g.unit + "]"));
    }
    for (const auto& [name, each] : v.items()) {
      if (rows.size() > most(f)) break;
      std::vector<std::string>& row = rows.emplace_back();
      if (f.by_name) row.push_back(name);
      for (const FieldInfo* g : shown)
        row.push_back(each.contains(g->name) && (is_shown(*g, each) || each[g->name].is_number())
                          ? value_text(*g, each[g->name], largest_[unit_of(*g, each)])
                          : "");
    }
    std::vector<std::size_t> width(rows[0].size());
    for (const auto& row : rows)
      for (std::size_t c = 0; c < row.size(); ++c) width[c] = std::max(width[c], row[c].size());
    line(indent, fmt::format("{}:", f.label));
    for (const auto& row : rows) {
      std::string text;
      for (std::size_t c = 0; c < row.size(); ++c) text += fmt::format("{:<{}}  ", row[c], width[c]);
      line(indent + 2, text);
    }
    rest(f, v.size(), indent + 2);
  }

  std::string& out_;
  std::map<std::string, double> largest_;
};

Json type_of(std::string_view type) {
  if (type.empty()) return Json::object();
  return {{"type", type == "number" ? Json({"number", "null"}) : Json(type)}};
}

Json object_schema(const Schema& schema);

Json field_schema(const FieldInfo& f) {
  Json schema = f.of != nullptr ? object_schema(*f.of) : type_of(f.type);
  if (f.by_name)
    schema = {{"type", "object"}, {"additionalProperties", schema}};
  else if (f.of != nullptr && f.depth == 0)
    schema["type"] = {"object", "null"};
  for (int k = 0; k < f.depth; ++k) schema = {{"type", "array"}, {"items", schema}};
  if (!f.label.empty()) schema["description"] = f.label;
  if (!f.unit.empty()) schema["unit"] = f.unit;
  return schema;
}

Json object_schema(const Schema& schema) {
  Json properties = Json::object(), required = Json::array();
  for (const FieldInfo& f : schema.fields) {
    properties[f.name] = field_schema(f);
    if (!f.optional) required.push_back(f.name);
  }
  return {{"type", "object"}, {"properties", properties}, {"required", required}, {"additionalProperties", false}};
}

// Common fields of all documents.
const Fields<Result> kDocumentFields{{"scene", "", "", &Result::scene, kUnlessEmpty},
                                     {"title", "", "", &Result::title, kUnlessEmpty},
                                     {"command", "", "", &Result::command, kUnlessEmpty}};

// "a/fb.csv, a/fb.png", and the folder of more than three only once: "a: fb.csv, fb.png, ...".
std::string files_text(const Json& files) {
  std::vector<std::string> names = files;
  const std::string folder = names.empty() ? "" : names.front().substr(0, names.front().rfind('/') + 1);
  const auto is_inside = [&](const std::string& name) { return name.starts_with(folder); };
  if (names.size() <= 3 || folder.size() < 2 || !std::ranges::all_of(names, is_inside)) return first_of(names);
  for (std::string& name : names) name.erase(0, folder.size());
  return folder.substr(0, folder.size() - 1) + ": " + first_of(names);
}

const Fields<Result> kLastFields{
    {"files", "", "written", &Result::files, files_text, kUnlessEmpty},
    {"findings", "", [](const Result&) { return CommandFindings::all(); }, kFindingFields}};

}  // namespace

std::string number_text(const Json& v, double largest) {
  if (v.is_null()) return "-";
  if (v.is_number_integer()) return v.dump();
  return fmt::format("{:.6g}", is_rounding(v, largest) ? 0.0 : v.get<double>());
}

std::string time_text(double seconds) {
  return seconds < 1 ? fmt::format("{:.0f} ms", std::ceil(1e3 * seconds)) : fmt::format("{:.3g} s", seconds);
}

std::string unless_zero(const Json& n) { return n == 0 ? std::string() : number_text(n); }

std::string vector_text(const Json& v, double largest) {
  largest = std::max(largest, largest_in(v));
  std::string text;
  for (const Json& x : v)
    text += (text.empty() ? "" : ", ") + (x.is_array() ? vector_text(x, largest) : number_text(x, largest));
  return "[" + text + "]";
}

void Result::write(const std::string& file, std::string_view text) {
  GrowingFile out(file);
  out.clear(), out.append(text), out.commit();
  files.push_back(file);
}

std::string csv_of(const std::vector<std::vector<std::string>>& lines) {
  std::string text;
  for (const auto& line : lines)
    for (std::size_t k = 0; k < line.size(); ++k) text += csv_cell(line[k]) + (k + 1 < line.size() ? "," : "\n");
  return text;
}

Json document_of(const Result& result) {
  Json all = kDocumentFields(result);
  for (const Result& each : result.each) {
    all["scenes"].push_back({{"scene", each.scene}, {"title", each.title}});
    all["scenes"].back().update(each.data);
  }
  if (!result.data.is_null()) all.update(result.data);
  all.update(kLastFields(result));
  return all;
}

std::string text_of(const Schema& schema, const Json& data) {
  std::string text;
  Printer(text, schema, data).fields(schema, data, 2);
  return text;
}

std::string text_of(const Result& result) {
  std::string text;
  for (const Result& each : result.each) text += (text.empty() ? "" : "\n") + text_of(each);
  if (result.schema == nullptr) return text;
  if (!result.title.empty()) text += result.title + "\n";
  const bool brief = !result.brief.empty();
  text += (brief ? result.brief : text_of(*result.schema, result.data)) + text_of(CommandFindings::added());
  if (brief && !result.files.empty()) return text + fmt::format("  {:<9}  {}\n", "written", first_of(result.files));
  return text + text_of(kLastFields.schema(), kLastFields(result));
}

Json schema_of(std::span<const Schema* const> results, bool several) {
  const Schema &first = kDocumentFields.schema(), &last = kLastFields.schema();
  Json any = Json::array();
  const auto add = [&](const std::vector<FieldInfo>& fields) {
    Schema whole = first;
    whole.fields.insert(whole.fields.end(), fields.begin(), fields.end());
    whole.fields.insert(whole.fields.end(), last.fields.begin(), last.fields.end());
    any.push_back(object_schema(whole));
  };
  std::vector<FieldInfo> all{{"scene", "", "", "string"}, {"title", "", "", "string"}};
  for (const Schema* schema : results) {
    add(schema->fields);
    for (FieldInfo f : schema->fields) f.optional = true, all.push_back(f);
  }
  const Schema scene{all};
  if (several) add({{"scenes", "", "scenes", "object", 1, &scene}});
  return any.size() == 1 ? any[0] : Json{{"anyOf", any}};
}

bool is_empty(const Json& v) {
  return v.is_null() || (v.is_boolean() && !v.get<bool>()) ||
         (v.is_string() && v.get_ref<const std::string&>().empty()) || (v.is_structured() && v.empty());
}

Json json_number(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

void print_document(const Json& j) {
  const std::string text = j.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
  std::fwrite(text.data(), 1, text.size(), stdout);  // the exit code reports what is not taken
}

void print(const Result& result, const Arguments& args) {
  if (result.schema == nullptr && result.each.empty()) return;
  if (args.has("--json")) return print_document(document_of(result));
  if (args.has("--quiet") && !result.printed)
    for (const Finding& f : CommandFindings::all())
      if (f.severity() == Severity::wrong) tell_error(f.text());
  if ((args.has("--quiet") && !result.even_if_quiet) || result.printed) return;
  const std::string text = text_of(result);
  std::FILE* to = args["--record"] == "-" ? stderr : stdout;
  std::fwrite(text.data(), 1, text.size(), to);
}

}  // namespace lockstep
