// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef RankLaunch_h
#define RankLaunch_h

/// What the environment tells of mpirun, before MPI is asked. Built without MPI, there is none.

/// How many processes mpirun started; 1 where it did not.
int LaunchedCount();

/// The number of this process, 0 where it was started alone.
int LaunchedRank();

#endif
