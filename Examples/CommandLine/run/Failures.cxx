// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Failures.h"

#include "Text.h"

#include "vtkObjectFactory.h"
#include "vtkOutputWindow.h"

#include <algorithm>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <initializer_list>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

namespace
{

/// All: the signals that people and batch systems send to end a program. Awaited: the signals in All
/// that were not ignored at the start; nohup, for example, starts a program that ignores hangups.
sigset_t All, Awaited;

void FindAwaited()
{
  sigemptyset(&All);
  sigemptyset(&Awaited);
  for (const int number : { SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGALRM, SIGUSR1, SIGUSR2 })
  {
    struct sigaction action = {};
    sigaddset(&All, number);
    sigaction(number, nullptr, &action);
    if (action.sa_handler != SIG_IGN)
    {
      sigaddset(&Awaited, number);
    }
  }
}

#ifdef __ELF__
/// Finds the awaited signals before libraries begin, because UCX, which comes with some MPI, handles
/// hangups itself from the moment when it is loaded.
__attribute__((section(".preinit_array"), used)) void (*const FindAwaitedFirst)() = FindAwaited;
#else
const bool FoundAwaited = (FindAwaited(), true);
#endif

/// The handler of crashes must not allocate memory, so it uses these arrays.
char Failure[PATH_MAX + 256] = "the run failed";
char Hint[PATH_MAX + 256] = "the OpenCL driver may be at fault, or memory ran out";
char StackOfHandler[1 << 16]; // after an endless recursion, the usual stack is full
volatile std::sig_atomic_t ClearsLine = 0;
volatile std::sig_atomic_t StandardError =
  STDERR_FILENO; ///< leads to the user even while an Activity is silent

/// FilesLock and Files are never destroyed, because the waiting thread lives as long as the process.
std::mutex& FilesLock = *new std::mutex;
std::vector<std::string>& Files = *new std::vector<std::string>;

void RemoveFiles()
{
  for (const std::string& file : Files)
  {
    unlink(file.c_str());
  }
}

template <std::size_t N>
void Set(char (&target)[N], const std::string& text)
{
  std::strncpy(target, text.c_str(), N - 1);
}

void SayInHandler(const char* text)
{
  const ssize_t ignored = write(StandardError, text, std::strlen(text));
  (void)ignored;
}

/// Handles a crash of a reader over a damaged file, or of a driver. No output is lost, because a
/// new file is complete before it replaces another one.
void EndByCrash(int number)
{
  RemoveFiles();
  SayInHandler(ClearsLine ? "\r\033[K" : "");
  for (const char* part : std::initializer_list<const char*>{
         "marching-correctors: ", Failure, ": ",
         number == SIGXCPU ? "it took too much processor time" : "the program crashed there",
         number == SIGSEGV     ? " (Segmentation fault)"
           : number == SIGABRT ? " (Aborted)"
           : number == SIGBUS  ? " (Bus error, as when a file becomes shorter while it is read)"
                               : "",
         "; ", Hint, "\n" })
  {
    SayInHandler(part);
  }
  _exit(1);
}

/// Waits for a signal. The program then ends as if by the signal itself, so that a shell or a batch
/// system sees the signal.
[[noreturn]] void EndBySignal()
{
  int number = 0;
  while (sigwait(&Awaited, &number) != 0)
  {
  }
  FilesLock.lock(); // for ever, so that no other file is made
  RemoveFiles();
  std::signal(number, SIG_DFL);
  sigset_t one;
  sigemptyset(&one);
  sigaddset(&one, number);
  pthread_sigmask(SIG_UNBLOCK, &one, nullptr);
  raise(number);
  _exit(1);
}

/// Returns only the sentence of a message: "It failed." for "ERROR: In F.cxx, line 1\nvtkClass
/// (0x55): It failed.\n\n" and for "Generic Warning: In F.cxx, line 1\nIt failed.\n\n".
std::string Sentence(const char* text)
{
  std::string message = text ? text : "";
  const std::size_t colon = message.find("): ", message.find(" (0x"));
  if (colon != std::string::npos)
  {
    message.erase(0, colon + 3);
  }
  else if (message.find(": In ") < message.find('\n'))
  {
    message.erase(0, message.find('\n') + 1);
  }
  if (message.find(" returned failure for request: ") != std::string::npos)
  {
    message = "VTK's reader gave up"; // the message has only a page of addresses
  }
  std::replace(message.begin(), message.end(), '\n', ' ');
  std::replace(message.begin(), message.end(), '\r', ' ');
  message.erase(message.find_last_not_of(' ') + 1);
  return message;
}

/// Takes the place of VTK's output window, and keeps the messages.
class Window : public vtkOutputWindow
{
public:
  static Window* New();
  vtkTypeMacro(Window, vtkOutputWindow);

  /// Keeps a warning that begins with "Error" as an error: if a file ends in mid-array, the legacy readers
  /// only warn ("Error reading ascii data").
  void DisplayText(const char* text) override
  {
    const std::string sentence = Sentence(text);
    (sentence.compare(0, 5, "Error") == 0 ? this->Kept.Errors : this->Kept.Warnings)
      .push_back(sentence);
  }

  void DisplayErrorText(const char* text) override
  {
    const std::string sentence = Sentence(text);
    // Ignores two errors about files that VTK itself writes: inf in the range of an array (arrays
    // are checked when they are used), and no points.
    if (sentence.find("reading InformationKey element") == std::string::npos &&
      sentence.find("No Points element available") == std::string::npos)
    {
      this->Kept.Errors.push_back(sentence);
    }
  }

  void DisplayDebugText(const char*) override {}

  KeptMessages Kept;
};
vtkStandardNewMacro(Window);

}

void KeptMessages::Check(const std::string& error) const
{
  Require(error.empty() && this->Errors.empty(), error.empty() ? this->FirstError() : error);
}

KeptMessages& Messages()
{
  static Window* const window = []
  {
    Window* const made = Window::New();
    vtkOutputWindow::SetInstance(made);
    return made;
  }();
  return window->Kept;
}

void KeepWatchOfCrashes()
{
  stack_t stack = {};
  stack.ss_sp = StackOfHandler;
  stack.ss_size = sizeof(StackOfHandler);
  sigaltstack(&stack, nullptr);
  struct sigaction action = {};
  action.sa_handler = EndByCrash;
  action.sa_flags = SA_ONSTACK | SA_RESETHAND;
  for (const int number : { SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGXCPU })
  {
    sigaction(number, &action, nullptr);
  }
  std::set_terminate(std::abort); // this writes no more lines
}

void PrepareForEnding()
{
  ClearsLine = isatty(STDERR_FILENO);
  // Ignores signals that would end the program in silence. Writing then fails with a message.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  KeepWatchOfCrashes();
  // All later threads leave these signals to one thread that waits for them. Unlike a handler, this
  // thread may lock and allocate. Ignored signals are blocked, too, but never awaited: if they were not blocked,
  // LLVM, which PoCL brings, would handle the ignored signals, and its handler unblocks all others.
  pthread_sigmask(SIG_BLOCK, &All, nullptr);
  try
  {
    std::thread(EndBySignal).detach();
  }
  catch (const std::system_error&) // if there is no thread, signals end the program at once
  {
    pthread_sigmask(SIG_UNBLOCK, &Awaited, nullptr);
  }
}

std::string FaultsOfDrivers(const std::string& device)
{
  std::string folder;
  for (const auto& [variable, below] :
    { std::make_pair("POCL_CACHE_DIR", ""), std::make_pair("XDG_CACHE_HOME", "/pocl/kcache"),
      std::make_pair("HOME", "/.cache/pocl/kcache") })
  {
    const char* value = std::getenv(variable);
    folder = folder.empty() && value && *value ? std::string(value) + below : folder;
  }
  const bool isNamed = device.rfind("built", 0) != 0 && access(folder.c_str(), F_OK) == 0;
  return "the OpenCL driver may be at fault" +
    (isNamed
        ? ", files that PoCL keeps may be damaged (remove the folder " + Printable(folder) + ")"
        : "") +
    ", or memory ran out";
}

Activity::Activity(const std::string& failure, const std::string& hint, bool isSilent)
  : Outer(Failure, Hint)
  , IsSilent(isSilent)
{
  Set(Failure, Printable(failure));
  Set(Hint, hint);
  if (isSilent)
  {
    std::fflush(stderr);
    const int before = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 0);
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (before >= 0 && nowhere >= 0)
    {
      StandardError = before;
      dup2(nowhere, STDERR_FILENO);
    }
    close(nowhere);
  }
}

Activity::~Activity()
{
  Set(Failure, this->Outer.first);
  Set(Hint, this->Outer.second);
  const int before = StandardError;
  if (this->IsSilent && before != STDERR_FILENO)
  {
    std::fflush(stderr);
    dup2(before, STDERR_FILENO);
    StandardError = STDERR_FILENO;
    close(before);
  }
}

int MakeTemporary(std::string& name)
{
  name += "XXXXXX";
  const std::lock_guard<std::mutex> guard(FilesLock);
  const int descriptor = mkstemp(&name[0]);
  descriptor >= 0 ? Files.push_back(name) : name.clear();
  return descriptor;
}

bool EndTemporary(const std::string& name, const std::string& target)
{
  // Renaming may hang, so it comes before the lock is taken.
  if (!target.empty() && std::rename(name.c_str(), target.c_str()) != 0)
  {
    return false;
  }
  const std::lock_guard<std::mutex> guard(FilesLock);
  if (target.empty())
  {
    unlink(name.c_str());
  }
  Files.erase(std::find(Files.begin(), Files.end(), name));
  return true;
}
