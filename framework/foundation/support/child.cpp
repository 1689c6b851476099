// SPDX-License-Identifier: BSD-3-Clause
#include "framework/foundation/support/child.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include <lockstep/error.h>

namespace lockstep {

ChildEnd run_child(std::vector<std::string> words, const std::string& folder, bool errors) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  int pipe[2];
  if (pipe2(pipe, O_CLOEXEC) != 0) throw FileError(std::string("a pipe cannot be made: ") + std::strerror(errno));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, pipe[1], STDOUT_FILENO);
  if (errors)
    posix_spawn_file_actions_adddup2(&actions, pipe[1], STDERR_FILENO);
  else
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int failed = posix_spawn(&child, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(pipe[1]);
  ChildEnd end;
  char block[4096];
  for (ssize_t n = 1; failed == 0 && (n > 0 || (n < 0 && errno == EINTR));)
    if (n = read(pipe[0], block, sizeof block); n > 0) end.text.append(block, static_cast<std::size_t>(n));
  close(pipe[0]);
  if (failed != 0)
    throw FileError("cannot start \"" + words[0] + "\": " + std::strerror(failed) + "; check that it can be executed");
  pid_t ended = 0;
  while ((ended = waitpid(child, &end.status, 0)) < 0 && errno == EINTR) {
  }
  if (ended < 0) throw FileError("the exit status of \"" + words[0] + "\" is unknown: " + std::strerror(errno));
  return end;
}

}  // namespace lockstep
