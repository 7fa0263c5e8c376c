// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Supervisor.h"

#include "SafeText.h"

#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <new>

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#ifdef __linux__
#include <sys/prctl.h>
#endif

namespace
{

/// Memory that both processes see. The child fills it in; one that went astray may have written
/// anything there, so texts are read up to their size and no further.
struct SharedState
{
  bool Finished = false; ///< the work has returned, and Status is its result
  int Status = 0;
  int Part = -1;                      ///< of the work that is being done; below 0: none
  char LastEnd[PATH_MAX + 1024] = ""; ///< what was said of the child before
  char Failure[PATH_MAX + 256] = "the run failed";
  char Hint[256] = "the OpenCL driver may be at fault, or memory ran out";
  char TemporaryFile[PATH_MAX] = "";
};

SharedState* Shared = nullptr;
volatile pid_t Child = 0;

/// What people and batch systems send to end a program.
const int EndingSignals[] = { SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGALRM, SIGUSR1, SIGUSR2 };

/// Those that are ignored, as hangups are under nohup.
sigset_t Ignored;

void FindIgnored()
{
  sigemptyset(&Ignored);
  for (const int number : EndingSignals)
  {
    struct sigaction action = {};
    sigaction(number, nullptr, &action);
    if (action.sa_handler == SIG_IGN)
    {
      sigaddset(&Ignored, number);
    }
  }
}

#ifdef __ELF__
/// Before libraries begin: UCX, which comes with some MPI, takes hangups for itself when it is loaded.
__attribute__((section(".preinit_array"), used)) void (*const FindIgnoredFirst)() = FindIgnored;
#else
const bool FoundIgnored = (FindIgnored(), true);
#endif

template <std::size_t N>
void Set(char (&target)[N], const std::string& text)
{
  std::strncpy(target, text.c_str(), N - 1);
}

template <std::size_t N>
std::string Get(const char (&source)[N])
{
  return std::string(source, strnlen(source, N));
}

void HandOn(int number)
{
  kill(Child, number);
}

/// Handlers for the signals that were not ignored, whatever libraries have made of them.
void SetHandlers(void (*handler)(int))
{
  for (const int number : EndingSignals)
  {
    struct sigaction action = {};
    action.sa_handler = sigismember(&Ignored, number) ? SIG_IGN : handler;
    sigaction(number, &action, nullptr);
  }
}

/// Runs in the child, and does not return.
[[noreturn]] void Work(const std::function<int(int)>& work, int first, pid_t parent)
{
#ifdef __linux__
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent)
  {
    _exit(1);
  }
#else
  (void)parent;
#endif
  // Writing fails then, which is told, where the signal would end the program in silence.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  Shared->Status = work(first);
  Shared->Finished = true;
  std::exit(Shared->Status);
}

/// Waits for the child's end, removes what it left, and returns what waitpid says of it.
int WaitAndCleanUp()
{
  // Not yet gone while signals are still handed on: its number could be another process's soon.
  siginfo_t ignored;
  while (
    waitid(P_PID, static_cast<id_t>(Child), &ignored, WEXITED | WNOWAIT) != 0 && errno == EINTR)
  {
  }
  const SignalPause pause;
  int status = 0;
  while (waitpid(Child, &status, 0) < 0 && errno == EINTR)
  {
  }
  const std::string file = Get(Shared->TemporaryFile);
  if (!file.empty())
  {
    std::remove(file.c_str());
  }
  SetHandlers(SIG_DFL);
  return status;
}

std::string Reason(int status)
{
  if (!WIFSIGNALED(status))
  {
    return "the program was ended in the middle of it";
  }
  switch (WTERMSIG(status))
  {
    case SIGKILL:
      return "the program was killed, as is done where memory runs out";
    case SIGXCPU:
      return "it took too much processor time";
    default:
      return std::string("the program crashed there (") + strsignal(WTERMSIG(status)) + ")";
  }
}

bool IsEndedBySignal(int status)
{
  for (const int number : EndingSignals)
  {
    if (WIFSIGNALED(status) && WTERMSIG(status) == number)
    {
      return true;
    }
  }
  return false;
}

/// What the exit status of the program is, after a sentence where the child could not say one.
int Report(int status)
{
  if (Shared->Finished)
  {
    return Shared->Status; // even where a driver crashed later, when it was unloaded
  }
  if (IsEndedBySignal(status))
  {
    raise(WTERMSIG(status)); // so that a shell or a batch system sees how the program ended
  }
  const std::string sentence =
    Get(Shared->Failure) + ": " + Reason(status) + "; " + Get(Shared->Hint);
  std::cerr << (isatty(STDERR_FILENO) ? "\r\033[K" : "");
  Say(sentence);
  Set(Shared->LastEnd, sentence);
  return 1;
}

/// Whether parts of the work are left that a new child can do.
bool GoesOn(int status, int first)
{
  return !Shared->Finished && !IsEndedBySignal(status) && Shared->Part >= first;
}

/// As at the start, but for the sentence.
void Reset()
{
  const std::string sentence = Get(Shared->LastEnd);
  *Shared = SharedState();
  Set(Shared->LastEnd, sentence);
}

/// Whether there is a child; it does the work from part `first` on.
bool StartChild(const std::function<int(int)>& work, int first)
{
  const pid_t self = getpid();
  {
    const SignalPause pause;
    Child = fork();
    SetHandlers(Child > 0 ? HandOn : SIG_DFL);
  }
  if (Child == 0)
  {
    Work(work, first, self);
  }
  return Child > 0;
}

}

//------------------------------------------------------------------------------
int RunSupervised(const std::function<int(int)>& work)
{
  void* memory =
    mmap(nullptr, sizeof(SharedState), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  std::cout.flush();
  if (memory != MAP_FAILED)
  {
    Shared = new (memory) SharedState;
  }
  int first = 0;
  while (memory != MAP_FAILED && StartChild(work, first))
  {
    const int status = WaitAndCleanUp();
    const bool goesOn = GoesOn(status, first);
    const int result = Report(status);
    if (!goesOn)
    {
      return result;
    }
    first = Shared->Part + 1;
    Reset();
  }
  const int error = errno;
  Say(std::string("no process could be started: ") + std::strerror(error));
  return 1;
}

//------------------------------------------------------------------------------
void BeginPart(int part)
{
  Shared->Part = part;
}

//------------------------------------------------------------------------------
std::string LastEnd()
{
  return Get(Shared->LastEnd);
}

//------------------------------------------------------------------------------
Activity::Activity(const std::string& failure, const std::string& hint)
  : OuterFailure(Get(Shared->Failure))
  , OuterHint(Get(Shared->Hint))
{
  Set(Shared->Failure, failure);
  Set(Shared->Hint, hint);
}

//------------------------------------------------------------------------------
Activity::~Activity()
{
  Set(Shared->Failure, this->OuterFailure);
  Set(Shared->Hint, this->OuterHint);
}

//------------------------------------------------------------------------------
SignalPause::SignalPause()
{
  sigset_t set;
  sigemptyset(&set);
  for (const int number : EndingSignals)
  {
    sigaddset(&set, number);
  }
  sigprocmask(SIG_BLOCK, &set, &this->Before);
}

//------------------------------------------------------------------------------
SignalPause::~SignalPause()
{
  sigprocmask(SIG_SETMASK, &this->Before, nullptr);
}

//------------------------------------------------------------------------------
void SetTemporaryFile(const std::string& file)
{
  Set(Shared->TemporaryFile, file);
}
