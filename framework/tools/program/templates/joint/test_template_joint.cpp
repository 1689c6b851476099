// Checks Jacobian, rates, right-hand side and stiffness of the joint against differences. Argument: plugin file.
#include <cstdio>

#include <lockstep/author/check.h>
#include <lockstep/author/loader.h>
#include <lockstep/author/registry.h>

int main(int argc, char** argv) try {
  using namespace lockstep;
  Registry registry = builtin_registry();
  load_plugin(registry, argc > 1 ? argv[1] : "template_joint");
  const CheckReport report = check_lock(registry, "template_joint", {{"height", 0.1}, {"length", 0.7}});
  std::fputs(report.text().c_str(), stdout);
  return report.ok() ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
