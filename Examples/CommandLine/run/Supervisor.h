// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Supervisor_h
#define Supervisor_h

#include <csignal>
#include <functional>
#include <string>

/// Does the work in a child process, and waits for it here. Readers of damaged files, OpenCL drivers
/// and graphics libraries can crash, abort, exit or use up all memory; none of that reaches this
/// process, which then says in one sentence what happened, and removes a file half written. Signals
/// sent to this process are handed on, and end both. Returns the exit status: what the work
/// returned, or 1. Where the work has parts (see BeginPart) and ended unexpectedly in one, it goes on
/// in a new child: work(first) begins with part `first`, the one after it; at the start that is 0.
int RunSupervised(const std::function<int(int first)>& work);

/// A part of the work begins: from 0, each one higher than those before it. Below 0: what comes now
/// belongs to no part.
void BeginPart(int part);

/// What was said of the unexpected end of the child before this one.
std::string LastEnd();

/// For as long as it lives, what is said if the work ends unexpectedly: "FAILURE: ...; HINT".
class Activity
{
public:
  Activity(const std::string& failure, const std::string& hint);
  ~Activity();
  Activity(const Activity&) = delete;
  void operator=(const Activity&) = delete;

private:
  std::string OuterFailure;
  std::string OuterHint;
};

/// While one lives, signals that end the program wait: for steps that belong together.
class SignalPause
{
public:
  SignalPause();
  ~SignalPause();
  SignalPause(const SignalPause&) = delete;
  void operator=(const SignalPause&) = delete;

private:
  sigset_t Before;
};

/// The file to remove should the work end unexpectedly; empty: none.
void SetTemporaryFile(const std::string& file);

#endif
