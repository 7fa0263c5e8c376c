// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * The group "In Use" of a filter's panel, folded at first. The group shows the filter's information
 * properties as they were after the last update; ParaView itself leaves out such properties. The group
 * must also have an ordinary property: ParaView creates the group's widget when it comes to this property.
 *
 * As soon as something is changed on the panel, before Apply, the group shows what the next update
 * would find (the properties that begin with Next, if the filter has them). The list of iso values
 * begins with the usual value for the array, and changes with the array until the user sets values.
 *
 * The panel of a new filter begins with what suits its particles: the free surface unless a gas
 * fills its bounds, filled regions in two dimensions, an estimate if there are no smoothing lengths,
 * and a plane or line through the fluid. Lists of arrays also offer what the filter accepts as an
 * array: blocks as fluid; vx, vy and vz as velocity. Fields of numbers that are not given show the
 * words "not given".
 *
 * In pictures of the output, the colours span the values on most of the area. Charts show only the
 * output's best array. The panel of a gauge or a flux has a button that plots it over time.
 */
#ifndef pqSPHInUse_h
#define pqSPHInUse_h

#include "pqPropertyWidget.h"

#include <QList>
#include <QMap>
#include <QPair>
#include <QTimer>

class QLabel;
class QPushButton;
class QToolButton;
class pqDataRepresentation;
class vtkSMProperty;
class vtkSMPropertyGroup;

class pqSPHInUse : public pqPropertyWidget
{
  Q_OBJECT
  using Superclass = pqPropertyWidget;

public:
  pqSPHInUse(vtkSMProxy* proxy, vtkSMPropertyGroup* group, QWidget* parent = nullptr);
  ~pqSPHInUse() override = default;

  void apply() override;

private Q_SLOTS:
  void showValues();
  void lookAhead();
  void beginNew();
  void offerMore();
  void showSmooth();
  void narrowColours();
  void plotOverTime();

private: // NOLINT(readability-redundant-access-specifiers)
  void showRows();
  void begin();
  void showNotGiven();
  void beginPlace();
  void colourLate();
  bool watchColour(pqDataRepresentation* shown);

  QToolButton* Button;
  QPushButton* Plot = nullptr;
  QLabel* Warning = nullptr; // beside the size of cubes
  bool HasLooked = false, WasEmpty = false; // a last output was seen; it was empty
  bool IsSmooth = false;
  QPair<int, double> Rough{ 0, 1.0 }; // Compact and Widening without Smooth
  QMap<pqDataRepresentation*, QString> Coloured; // the array that colours each picture
  QString Colour;      // the array that the last output is best coloured by; empty: none
  QList<double> Given; // the iso value that the panel chose last; empty: the user chooses

  QList<QPair<vtkSMProperty*, QLabel*>> Rows;
  QTimer Pause; // waits between the last change and the look ahead
};

#endif
