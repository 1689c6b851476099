// Checks the law's derivatives against differences, and that its breakpoints list all jumps. Argument: plugin file.
#include <cstdio>

#include <lockstep/author/check.h>
#include <lockstep/author/loader.h>
#include <lockstep/author/registry.h>

int main(int argc, char** argv) try {
  using namespace lockstep;
  Registry registry = builtin_registry();
  load_plugin(registry, argc > 1 ? argv[1] : "template_law");
  const auto law = registry.laws.make("template_law", {{"rise", 0.3}, {"time", 0.2}, {"start", 0.5}}, &registry, "law");
  const CheckReport report = check_law(*law, {.from = 0, .to = 2}, "template_law");
  std::fputs(report.text().c_str(), stdout);
  return report.ok() ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
