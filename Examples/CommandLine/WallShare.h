// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/// At which share of the weight the layer of solids next to the fluid lies.
#ifndef WallShare_h
#define WallShare_h

class vtkPointSet;
struct CommandLineOptions;

/// The solids' share of the weight sum at the solids themselves: the median, each one counting as much as
/// the fluid weighs there, so that those that no fluid reaches do not count. A surface that ends at this share ends, in the median,
/// on the solids that face the fluid, whether they are one layer or more and how far away the fluid keeps. 0.5 where
/// fluid reaches no solid. Throws std::runtime_error with one sentence.
double MeasureWallShare(const CommandLineOptions& options, vtkPointSet* particles);

#endif
