// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "pqSPHInUse.h"

#include "pqActiveObjects.h"
#include "pqApplicationCore.h"
#include "pqCoreUtilities.h"
#include "pqDataRepresentation.h"
#include "pqOutputPort.h"
#include "pqPipelineSource.h"
#include "pqProxy.h"
#include "pqProxyWidget.h"
#include "pqServerManagerModel.h"
#include "pqUndoStack.h"
#include "vtkCommand.h"
#include "vtkDataObject.h"
#include "vtkDataSetAttributes.h"
#include "vtkNew.h"
#include "vtkOutputWindow.h"
#include "vtkPVArrayInformation.h"
#include "vtkPVDataInformation.h"
#include "vtkPVDataSetAttributesInformation.h"
#include "vtkSMArrayListDomain.h"
#include "vtkSMChartSeriesSelectionDomain.h"
#include "vtkSMDocumentation.h"
#include "vtkSMDoubleVectorProperty.h"
#include "vtkSMInputProperty.h"
#include "vtkSMPVRepresentationProxy.h"
#include "vtkSMParaViewPipelineControllerWithRendering.h"
#include "vtkSMProperty.h"
#include "vtkSMPropertyGroup.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMPropertyIterator.h"
#include "vtkSMProxy.h"
#include "vtkSMSessionProxyManager.h"
#include "vtkSMSourceProxy.h"
#include "vtkSMTransferFunctionManager.h"
#include "vtkSMTransferFunctionProxy.h"
#include "vtkSMUncheckedPropertyHelper.h"
#include "vtkSMVectorProperty.h"
#include "vtkSMViewProxy.h"
#include "vtkSmartPointer.h"

#include <QComboBox>
#include <QFormLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QRegularExpression>
#include <QSignalBlocker>
#include <QStringList>
#include <QTableView>
#include <QToolButton>
#include <QVBoxLayout>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace
{
// Properties that tell what the next update would find.
const char* const NEXT[] = { "NextScalarRange", "NextIsoValue", "NextArray", "NextComponents",
  "NextDimension", "NextFreeSurface", "NextFluid", "NextCells", "NextWarning" };

// The items of ParaView's lists of arrays have these roles: association and name.
constexpr int ASSOCIATION = Qt::UserRole + 1, ARRAY_NAME = Qt::UserRole + 2;

// Rounds a number to six digits, which the rest of the panel shows, too.
double rounded(double value)
{
  return QString::number(value).toDouble();
}

// Returns the values as text; "-" if all values are 0 or empty, because nothing was drawn, or because
// a free surface has no such value.
QString textOf(vtkSMProperty* property)
{
  const vtkSMPropertyHelper values(property, true);
  const bool isNumber = vtkSMDoubleVectorProperty::SafeDownCast(property) != nullptr;
  QStringList texts;
  bool isKnown = false;
  for (unsigned int i = 0; i < values.GetNumberOfElements(); ++i)
  {
    texts << (isNumber ? QString::number(values.GetAsDouble(i))
                       : QString::fromUtf8(values.GetAsString(i)));
    isKnown = isKnown || (isNumber ? values.GetAsDouble(i) != 0.0 : !texts.back().isEmpty());
  }
  return isKnown ? texts.join(" to ") : QString("-");
}

// Lists the names of the properties that a user sets, except inputs and commands.
QStringList namesOf(vtkSMProxy* filter)
{
  QStringList names;
  const auto each = vtkSmartPointer<vtkSMPropertyIterator>::Take(filter->NewPropertyIterator());
  for (each->Begin(); !each->IsAtEnd(); each->Next())
  {
    vtkSMProperty* property = each->GetProperty();
    if (vtkSMVectorProperty::SafeDownCast(property) && !property->GetInformationOnly() &&
      !vtkSMInputProperty::SafeDownCast(property))
    {
      names << each->GetKey();
    }
  }
  return names;
}

// Shows only the series of a chart whose names match.
void showSeries(vtkSMProxy* chart, const QRegularExpression& names)
{
  if (!chart->GetProperty("SeriesVisibility"))
  {
    return;
  }
  vtkSMPropertyHelper visible(chart, "SeriesVisibility");
  for (unsigned int i = 0; i + 1 < visible.GetNumberOfElements(); i += 2)
  {
    visible.Set(i + 1, names.match(visible.GetAsString(i)).hasMatch() ? "1" : "0");
  }
  chart->UpdateVTKObjects();
}

bool isNew(vtkSMProxy* filter)
{
  auto* found = pqApplicationCore::instance()->getServerManagerModel()->findItem<pqProxy*>(filter);
  return found && found->modifiedState() == pqProxy::UNINITIALIZED;
}

// Returns the filter's first output; nullptr before the first update.
pqOutputPort* outputOf(vtkSMProxy* filter)
{
  auto* source =
    pqApplicationCore::instance()->getServerManagerModel()->findItem<pqPipelineSource*>(filter);
  return source && !isNew(filter) ? source->getOutputPort(0) : nullptr;
}
}

pqSPHInUse::pqSPHInUse(vtkSMProxy* proxy, vtkSMPropertyGroup* group, QWidget* parent)
  : pqPropertyWidget(proxy, parent)
{
  this->setShowLabel(true); // the group's label, as a heading
  auto* all = new QVBoxLayout(this);
  all->setContentsMargins(0, 0, 0, 0);
  this->Button = new QToolButton(this);
  this->Button->setObjectName("Show");
  this->Button->setText("What was found, and what is used");
  this->Button->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
  this->Button->setAutoRaise(true);
  this->Button->setCheckable(true);
  auto* values = new QWidget(this);
  values->setObjectName("Values");
  all->addWidget(this->Button);
  all->addWidget(values);
  const auto show = [this, values](bool on)
  {
    this->Button->setArrowType(on ? Qt::DownArrow : Qt::RightArrow);
    values->setVisible(on);
  };
  this->connect(this->Button, &QToolButton::toggled, show);
  show(false);
  auto* form = new QFormLayout(values);
  form->setContentsMargins(0, 0, 0, 0);
  form->setRowWrapPolicy(QFormLayout::WrapLongRows);
  if (proxy->GetProperty("Level"))
  {
    this->Plot = new QPushButton("Plot Over Time", this);
    this->Plot->setObjectName("Plot");
    this->Plot->setToolTip("Draws a chart of the level, or of the volume flux, at all times.");
    all->insertWidget(0, this->Plot);
    this->connect(this->Plot, SIGNAL(clicked()), SLOT(plotOverTime()));
    vtkSMChartSeriesSelectionDomain::AddSeriesVisibilityDefault("^time( |$)", false);
  }
  for (unsigned int i = 0; i < group->GetNumberOfProperties(); ++i)
  {
    vtkSMProperty* property = group->GetProperty(i);
    if (!property->GetInformationOnly())
    {
      form->addRow(pqProxyWidget::createWidgetForProperty(property, proxy, values));
      continue;
    }
    auto* value = new QLabel(values);
    value->setObjectName(property->GetXMLName());
    value->setWordWrap(true);
    value->setTextInteractionFlags(Qt::TextSelectableByMouse);
    if (vtkSMDocumentation* documentation = property->GetDocumentation())
    {
      value->setToolTip(QString::fromUtf8(documentation->GetDescription()).simplified());
    }
    form->addRow(QString::fromUtf8(property->GetXMLLabel()) + ":", value);
    this->Rows << qMakePair(property, value);
  }
  // The call is queued, because during the first update ParaView still treats the filter as new.
  pqCoreUtilities::connect(
    proxy, vtkCommand::UpdateDataEvent, this, SLOT(showValues()), Qt::QueuedConnection);
  for (const char* name : { "FluidArray", "SelectInputScalars" })
  {
    vtkSMProperty* property = proxy->GetProperty(name);
    auto* domain = property ? property->FindDomain<vtkSMArrayListDomain>() : nullptr;
    if (domain)
    {
      pqCoreUtilities::connect(
        domain, vtkCommand::DomainModifiedEvent, this, SLOT(offerMore()), Qt::QueuedConnection);
    }
  }
  QTimer::singleShot(0, this, SLOT(beginNew())); // ParaView calls it new only later
  if (!proxy->GetProperty(NEXT[0]))
  {
    this->showValues();
    return;
  }
  this->IsSmooth = vtkSMPropertyHelper(proxy, "Smooth").GetAsInt() != 0;
  for (const char* name : { "Smooth", "Filled" })
  {
    pqCoreUtilities::connect(proxy->GetProperty(name), vtkCommand::UncheckedPropertyModifiedEvent,
      this, SLOT(showSmooth()));
  }
  this->Pause.setSingleShot(true);
  this->Pause.setInterval(200);
  this->connect(&this->Pause, SIGNAL(timeout()), SLOT(lookAhead()));
  for (const QString& name : namesOf(proxy))
  {
    pqCoreUtilities::connect(proxy->GetProperty(name.toUtf8().constData()),
      vtkCommand::UncheckedPropertyModifiedEvent, &this->Pause, SLOT(start()));
  }
  this->showValues();
}

void pqSPHInUse::beginNew()
{
  vtkSMProxy* filter = this->proxy();
  this->offerMore();
  this->showNotGiven();
  auto* item = pqApplicationCore::instance()->getServerManagerModel()->findItem<pqProxy*>(filter);
  if (this->Plot && item)
  {
    const auto enable = [this] { this->Plot->setEnabled(!isNew(this->proxy())); };
    this->connect(item, &pqProxy::modifiedStateChanged, this, enable);
    enable();
  }
  if (!isNew(filter))
  {
    return;
  }
  SCOPED_UNDO_EXCLUDE();
  this->WasEmpty = false; // it has not been updated yet
  const QString label = filter->GetXMLLabel();
  const QString brief = label.section('(', 0, 0).remove(QRegularExpression("[^A-Za-z0-9]"));
  if (label.contains('('))
  {
    item->rename(QString::fromStdString(
      filter->GetSessionProxyManager()->GetUniqueProxyName("sources", brief.toUtf8().constData())));
  }
  if (filter->GetProperty("NextBounds"))
  {
    this->beginPlace();
  }
  if (vtkSMPropertyHelper(filter, "NextEstimate").GetAsInt() != 0)
  {
    vtkSMUncheckedPropertyHelper(filter, "EstimateSmoothingLength").Set(1);
    this->Button->setText("What was found, and what is used (the smoothing length is estimated)");
  }
  if (filter->GetProperty(NEXT[0]))
  {
    this->Given << std::numeric_limits<double>::quiet_NaN(); // none yet
    this->lookAhead();
    // Most users want to see the water; without an array, there is nothing else to draw.
    const bool isFree = vtkSMPropertyHelper(filter, "NextFreeSurface").GetAsInt() != 0 ||
      !*vtkSMPropertyHelper(filter, "NextArray").GetAsString();
    vtkSMUncheckedPropertyHelper(filter, "FreeSurface").Set(isFree ? 1 : 0);
    // Lines are hard to see, so surfaces of particles in a plane begin filled.
    vtkSMUncheckedPropertyHelper(filter, "Filled")
      .Set(vtkSMPropertyHelper(filter, "NextDimension").GetAsInt() == 2 ? 1 : 0);
  }
}

// Sets a slice through the middle of the fluid, or in the plane of the particles; or sets a line
// through the densest part of the fluid: upright for a gauge, else along the fluid's longest side. The
// line ends somewhat beyond the fluid.
void pqSPHInUse::beginPlace()
{
  vtkSMProxy* filter = this->proxy();
  const vtkSMPropertyHelper fluid(filter, "NextBounds");
  const vtkSMPropertyHelper input(filter, "Input");
  vtkPVDataInformation* data =
    vtkSMSourceProxy::SafeDownCast(input.GetAsProxy())->GetDataInformation(input.GetOutputPort());
  double low[3], high[3], middle[3], normal[3] = { 0.0, 0.0, 1.0 };
  double filled = 1.0; // volume of the bounds; in a plane, their area
  int longest = 0, up = 2, axes = 0;
  for (int a = 0; a < 3; ++a)
  {
    low[a] = fluid.GetAsDouble(2 * a);
    high[a] = fluid.GetAsDouble(2 * a + 1);
    middle[a] = rounded(0.5 * low[a] + 0.5 * high[a]);
    longest = high[a] - low[a] > high[longest] - low[longest] ? a : longest;
    filled *= high[a] > low[a] ? high[a] - low[a] : 1.0;
    axes += high[a] > low[a] ? 1 : 0;
  }
  const double length = high[longest] - low[longest];
  if (!(length > 0.0))
  {
    return; // the bounds are not known
  }
  for (int a = 0; a < 3; ++a)
  {
    if (low[a] == high[a])
    {
      middle[a] = low[a];
      std::fill_n(normal, 3, 0.0);
      normal[a] = 1.0;
      up = a == 2 ? 1 : 2;
    }
  }
  const bool isGauge = filter->GetProperty("Level") != nullptr;
  if (isGauge && up == 2)
  {
    // Up is z, unless walls rise above the water along y, and more than along z.
    double all[6];
    data->GetBounds(all);
    const auto above = [&all, &low, &high](int a)
    { return all[2 * a + 1] - high[a] - (low[a] - all[2 * a]); };
    up = above(1) > 0.01 * (high[1] - low[1]) && above(1) > above(2) ? 1 : 2;
  }
  const int along = isGauge ? up : longest;
  double from[3], to[3];
  const vtkSMPropertyHelper densest(filter, "NextDensest");
  for (int a = 0; a < 3; ++a)
  {
    from[a] = to[a] = low[a] == high[a] ? low[a] : rounded(densest.GetAsDouble(3 * along + a));
  }
  // The line ends beyond the surface, which lies half a spacing above the uppermost particles.
  const double spacing =
    std::pow(filled / static_cast<double>(data->GetNumberOfPoints()), 1.0 / axes);
  const double margin = std::max(0.05 * length, 2.0 * spacing);
  from[along] = rounded(low[along] - margin);
  to[along] = rounded(high[along] + margin);
  const std::pair<const char*, const double*> places[] = { { "Origin", middle },
    { "Normal", normal }, { "Point1", from }, { "Point2", to } };
  for (const auto& place : places)
  {
    if (filter->GetProperty(place.first))
    {
      vtkSMPropertyHelper(filter, place.first).Set(place.second, 3);
    }
  }
}

void pqSPHInUse::offerMore()
{
  QWidget* panel = this->parentWidget();
  vtkSMProxy* filter = this->proxy();
  const auto offer = [panel](const char* list, const QString& name)
  {
    auto* widget = panel ? panel->findChild<QWidget*>(list) : nullptr;
    auto* combo = widget ? widget->findChild<QComboBox*>() : nullptr;
    if (combo && combo->findData(name, ARRAY_NAME) < 0)
    {
      const QSignalBlocker block(combo);
      const bool isScalar = QLatin1String(list) == QLatin1String("SelectInputScalars");
      combo->addItem(name);
      combo->setItemData(combo->count() - 1, isScalar ? vtkDataObject::POINT : -1, ASSOCIATION);
      combo->setItemData(combo->count() - 1, name, ARRAY_NAME);
    }
  };
  if (filter->GetProperty("NextBlocks"))
  {
    filter->UpdatePropertyInformation(filter->GetProperty("NextBlocks"));
    const QString blocks = vtkSMPropertyHelper(filter, "NextBlocks").GetAsString();
    for (const QString& block : blocks.split('\n'))
    {
      if (!block.isEmpty())
      {
        offer("FluidArray", block);
      }
    }
  }
  vtkSMProperty* scalars = filter->GetProperty("SelectInputScalars");
  auto* arrays = scalars ? scalars->FindDomain<vtkSMArrayListDomain>() : nullptr;
  unsigned int at;
  if (arrays && arrays->IsInDomain("vx", at) && arrays->IsInDomain("vy", at) &&
    arrays->IsInDomain("vz", at) && !arrays->IsInDomain("Velocity", at))
  {
    offer("SelectInputScalars", "Velocity");
  }
}

// A field whose 0 means "not given" shows these words, in grey, until a person clicks into it.
void pqSPHInUse::showNotGiven()
{
  QWidget* panel = this->parentWidget();
  for (const char* name : { "SmoothingLength", "ParticleVolume", "Mass", "Density", "CubeSize" })
  {
    auto* field = panel ? panel->findChild<QWidget*>(name) : nullptr;
    auto* edit = field ? field->findChild<QLineEdit*>() : nullptr;
    if (!edit)
    {
      continue;
    }
    edit->setPlaceholderText("not given");
    const auto hide = [edit]
    {
      if (edit->text() == "0" && !edit->hasFocus())
      {
        edit->clear();
      }
    };
    this->connect(edit, &QLineEdit::textChanged, edit, hide);
    this->connect(edit, &QLineEdit::editingFinished, edit, hide);
    hide();
  }
}

// While Smooth is on, Compact and Widening show in grey the values that Smooth stands for.
void pqSPHInUse::showSmooth()
{
  vtkSMUncheckedPropertyHelper smooth(this->proxy(), "Smooth"), compact(this->proxy(), "Compact"),
    widening(this->proxy(), "Widening");
  const bool isSmooth = smooth.GetAsInt() != 0, wasSmooth = std::exchange(this->IsSmooth, isSmooth);
  const bool isFilled = vtkSMUncheckedPropertyHelper(this->proxy(), "Filled").GetAsInt() != 0;
  if (isSmooth && !wasSmooth)
  {
    this->Rough = { compact.GetAsInt(), widening.GetAsDouble() };
  }
  if (isSmooth || wasSmooth)
  {
    compact.Set(isSmooth && !isFilled ? 1 : this->Rough.first);
  }
  if (isSmooth != wasSmooth)
  {
    widening.Set(isSmooth && this->Rough.second == 1.0 ? 2.0 : this->Rough.second);
  }
}

void pqSPHInUse::showValues()
{
  this->Pause.stop();
  this->proxy()->UpdatePropertyInformation();
  this->colourLate();
  this->showRows();
}

// ParaView chooses colours when it first shows something. Until a person takes another colour, the
// panel chooses anew if nothing was visible before (after an error, or with an iso value outside of
// the range), or if another array is the best one now. Warns if the output becomes empty.
void pqSPHInUse::colourLate()
{
  pqOutputPort* port = outputOf(this->proxy());
  const bool isFirst = !std::exchange(this->HasLooked, true);
  if (!port)
  {
    return;
  }
  vtkPVDataInformation* data = port->getDataInformation();
  const bool isEmpty = data->GetNumberOfPoints() + data->GetNumberOfRows() == 0;
  vtkPVArrayInformation* active =
    data->GetPointDataInformation()->GetAttributeInformation(vtkDataSetAttributes::SCALARS);
  const QString before = std::exchange(this->Colour, active ? active->GetName() : "");
  if (isFirst)
  {
    this->WasEmpty = isEmpty; // the filter is older than the panel
    for (pqDataRepresentation* shown : port->getRepresentations(nullptr))
    {
      this->watchColour(shown);
    }
    return;
  }
  if (isEmpty && !this->WasEmpty &&
    vtkSMPropertyHelper(this->proxy(), "MessageCount", true).GetAsInt() == 0)
  {
    const QString text = "The output of " + port->getSource()->getSMName() +
      " is empty: nothing is drawn. See In Use, at the end of its properties, for what was "
      "found.\n";
    vtkOutputWindowDisplayWarningText(text.toUtf8().constData());
  }
  for (pqDataRepresentation* shown : port->getRepresentations(nullptr))
  {
    auto* proxy = vtkSMPVRepresentationProxy::SafeDownCast(shown->getProxy());
    const QString colour = proxy && proxy->GetUsingScalarColoring()
      ? vtkSMPropertyHelper(proxy, "ColorArrayName").GetAsString(4)
      : "";
    if (proxy && active && colour == before && before != this->Colour)
    {
      vtkSMProxy* view = shown->getViewProxy();
      vtkSMProxy* oldColours = vtkSMPropertyHelper(proxy, "LookupTable").GetAsProxy();
      const bool hasLegend = view && (before.isEmpty() || proxy->IsScalarBarVisible(view));
      proxy->SetScalarColoring(active->GetName(), vtkDataObject::POINT);
      proxy->RescaleTransferFunctionToDataRange();
      if (hasLegend)
      {
        vtkNew<vtkSMTransferFunctionManager>()->HideScalarBarIfNotNeeded(oldColours, view);
        proxy->SetScalarBarVisibility(view, true);
      }
      shown->renderViewEventually();
    }
    if (!this->Coloured.contains(shown) && active)
    {
      showSeries(shown->getProxy(), QRegularExpression("^" +
        QRegularExpression::escape(active->GetName()) + "(_Magnitude)?$"));
    }
  }
  this->narrowColours();
  this->WasEmpty = isEmpty;
  this->Button->setText(isEmpty ? "The output is empty: what was found, and what is used"
                                : "What was found, and what is used");
}

// Puts ParaView's Plot Data Over Time behind this filter, as a person would, and shows one quantity
// alone.
void pqSPHInUse::plotOverTime()
{
  const bool isGauge = this->proxy()->GetProperty("Point1") != nullptr;
  BEGIN_UNDO_SET("Plot Over Time");
  const auto plot = vtkSmartPointer<vtkSMSourceProxy>::Take(vtkSMSourceProxy::SafeDownCast(
    this->proxy()->GetSessionProxyManager()->NewProxy("filters", "PlotDataOverTime")));
  vtkNew<vtkSMParaViewPipelineControllerWithRendering> controller;
  controller->PreInitializeProxy(plot);
  vtkSMPropertyHelper(plot, "Input").Set(this->proxy());
  vtkSMPropertyHelper(plot, "FieldAssociation").Set(vtkDataObject::ROW);
  vtkSMPropertyHelper(plot, "Only Report Selection Statistics").Set(0);
  controller->PostInitializeProxy(plot);
  controller->RegisterPipelineProxy(plot);
  plot->UpdatePipeline();
  const auto view = vtkSmartPointer<vtkSMViewProxy>::Take(vtkSMViewProxy::SafeDownCast(
    this->proxy()->GetSessionProxyManager()->NewProxy("views", "XYChartView")));
  controller->InitializeProxy(view);
  controller->RegisterViewProxy(view);
  controller->AssignViewToLayout(view);
  showSeries(controller->Show(plot, 0, view), QRegularExpression("^(last|volume_flux)\\b"));
  vtkSMPropertyHelper(view, "LeftAxisTitle").Set(isGauge ? "Level along the line" : "Volume flux");
  vtkSMPropertyHelper(view, "BottomAxisTitle").Set("Time");
  view->UpdateVTKObjects();
  view->StillRender();
  pqActiveObjects::instance().setActiveSource(
    pqApplicationCore::instance()->getServerManagerModel()->findItem<pqPipelineSource*>(plot));
  END_UNDO_SET();
}

// Returns whether the picture has been coloured by another array since the last call.
bool pqSPHInUse::watchColour(pqDataRepresentation* shown)
{
  vtkSMProperty* property = shown->getProxy()->GetProperty("ColorArrayName");
  if (!this->Coloured.contains(shown))
  {
    // Forgets a picture that is destroyed, because a later one may have the same address.
    this->connect(
      shown, &QObject::destroyed, this, [this, shown] { this->Coloured.remove(shown); });
    if (property)
    {
      pqCoreUtilities::connect(
        property, vtkCommand::ModifiedEvent, this, SLOT(narrowColours()), Qt::QueuedConnection);
    }
  }
  const QString name = property ? vtkSMPropertyHelper(property).GetAsString(4) : "";
  return name != std::exchange(this->Coloured[shown], name);
}

// ParaView's own colour range covers all values, so a few drops or corners decide it. If ParaView has
// taken its own range, or colours by another array, the colours get the range on most of the area.
void pqSPHInUse::narrowColours()
{
  SCOPED_UNDO_EXCLUDE();
  const QString ranges = vtkSMPropertyHelper(this->proxy(), "ColorRanges", true).GetAsString();
  pqOutputPort* port = outputOf(this->proxy());
  for (pqDataRepresentation* shown :
    port ? port->getRepresentations(nullptr) : QList<pqDataRepresentation*>())
  {
    auto* proxy = vtkSMPVRepresentationProxy::SafeDownCast(shown->getProxy());
    const bool isOther = this->watchColour(shown);
    if (!proxy || !proxy->GetUsingScalarColoring())
    {
      continue;
    }
    const QString name = this->Coloured[shown];
    vtkPVArrayInformation* array =
      port->getDataInformation()->GetPointDataInformation()->GetArrayInformation(
        name.toUtf8().constData());
    vtkSMProxy* colours = vtkSMPropertyHelper(proxy, "LookupTable").GetAsProxy();
    const QRegularExpressionMatch found =
      QRegularExpression("^(\\S+) (\\S+) " + QRegularExpression::escape(name) + "$",
        QRegularExpression::MultilineOption)
        .match(ranges);
    double now[2];
    if (!array || !colours || !found.hasMatch() ||
      !vtkSMTransferFunctionProxy::GetRange(colours, now))
    {
      continue;
    }
    const bool isVector = array->GetNumberOfComponents() > 1;
    const double* all = array->GetComponentRange(isVector ? -1 : 0);
    if ((isOther || (now[0] == all[0] && now[1] == all[1])) &&
      !(isVector && vtkSMPropertyHelper(colours, "VectorMode").GetAsInt() != 0))
    {
      vtkSMTransferFunctionProxy::RescaleTransferFunction(
        colours, found.captured(1).toDouble(), found.captured(2).toDouble());
      shown->renderViewEventually();
    }
  }
}

// Shows what the next Apply would find. For this, a hidden filter gets the values that the panel shows,
// applied or not. The range that the hidden filter finds is the domain of the list of iso values.
void pqSPHInUse::lookAhead()
{
  SCOPED_UNDO_EXCLUDE(); // the user did nothing
  vtkSMProxy* filter = this->proxy();
  const auto twin = vtkSmartPointer<vtkSMProxy>::Take(
    filter->GetSessionProxyManager()->NewProxy(filter->GetXMLGroup(), filter->GetXMLName()));
  if (!twin)
  {
    return;
  }
  const vtkSMPropertyHelper input(filter, "Input");
  vtkSMPropertyHelper(twin, "Input").Set(input.GetAsProxy(), input.GetOutputPort());
  for (const QString& name : namesOf(filter))
  {
    const QByteArray key = name.toUtf8();
    vtkSMPropertyHelper shown(filter, key.constData());
    shown.SetUseUnchecked(true);
    vtkSMPropertyHelper(twin, key.constData()).Copy(shown);
  }
  twin->UpdateVTKObjects();
  for (const char* name : NEXT)
  {
    twin->UpdatePropertyInformation(twin->GetProperty(name));
    vtkSMPropertyHelper(filter, name).Copy(vtkSMPropertyHelper(twin, name));
  }
  this->begin();
  this->showRows();
}

// A new filter's panel begins with an array and an iso value. The iso value changes with the array until
// the user sets a value. A filter that was loaded, or made by a script, stays as it is.
void pqSPHInUse::begin()
{
  vtkSMProxy* filter = this->proxy();
  const double found = vtkSMPropertyHelper(filter, "NextIsoValue").GetAsDouble();
  const vtkSMPropertyHelper range(filter, "NextScalarRange");
  const bool isWithin =
    rounded(found) > range.GetAsDouble(0) && rounded(found) < range.GetAsDouble(1);
  const double iso = isWithin ? rounded(found) : found;
  vtkSMUncheckedPropertyHelper array(filter, "SelectInputScalars");
  const char* first = vtkSMPropertyHelper(filter, "NextArray").GetAsString();
  if (isNew(filter) && first && *first && QLatin1String(array.GetAsString(4)) == "(automatic)")
  {
    array.Set(4, first);
  }
  vtkSMUncheckedPropertyHelper values(filter, "ContourValues");
  const bool isNone =
    this->Given.size() == 1 && std::isnan(this->Given.front()) && values.GetNumberOfElements() == 0;
  const bool isGiven = this->Given.size() == 1 && values.GetNumberOfElements() == 1 &&
    values.GetAsDouble(0) == this->Given.front();
  if ((isNone || isGiven) && std::isfinite(iso) && iso != this->Given.front())
  {
    values.Set(&iso, 1);
    this->Given = QList<double>{ iso };
  }
}

// Drops the empty rows of the list of iso values, which would count as 0. The panel's other widgets
// were applied before.
void pqSPHInUse::apply()
{
  QWidget* panel = this->parentWidget();
  auto* list = panel ? panel->findChild<QWidget*>("ContourValues") : nullptr;
  auto* table = list ? list->findChild<QTableView*>() : nullptr;
  if (!table || !this->proxy()->GetProperty("ContourValues"))
  {
    this->Superclass::apply();
    return;
  }
  vtkSMPropertyHelper values(this->proxy(), "ContourValues");
  const int rows = table->model()->rowCount();
  std::vector<double> kept;
  for (int row = 0; row < rows && row < static_cast<int>(values.GetNumberOfElements()); ++row)
  {
    if (!table->model()->index(row, 0).data(Qt::EditRole).toString().trimmed().isEmpty())
    {
      kept.push_back(values.GetAsDouble(static_cast<unsigned int>(row)));
    }
  }
  if (static_cast<int>(kept.size()) < rows)
  {
    values.SetNumberOfElements(0);
    values.Set(kept.data(), static_cast<unsigned int>(kept.size()));
  }
  this->Superclass::apply();
}

void pqSPHInUse::showRows()
{
  for (const auto& row : this->Rows)
  {
    const QLatin1String name(row.first->GetXMLName());
    const bool isDrawn = !this->WasEmpty && !isNew(this->proxy());
    QString text = textOf(row.first);
    if (text == "-" &&
      (name == QLatin1String("NextFluid") || (name == QLatin1String("UsedFluid") && isDrawn)))
    {
      text = "all particles";
    }
    row.second->setText(text);
  }
  QWidget* panel = this->parentWidget();
  auto* size = panel ? panel->findChild<QWidget*>("CubeSizeFactor") : nullptr;
  auto* box = size ? qobject_cast<QBoxLayout*>(size->layout()) : nullptr;
  if (box && !this->Warning)
  {
    box->setDirection(QBoxLayout::TopToBottom);
    this->Warning = new QLabel(size);
    this->Warning->setObjectName("Warning");
    this->Warning->setWordWrap(true);
    this->Warning->setStyleSheet("color: #c00000; font-weight: bold");
    box->addWidget(this->Warning);
  }
  if (this->Warning)
  {
    const QString text = vtkSMPropertyHelper(this->proxy(), "NextWarning", true).GetAsString();
    this->Warning->setText(text);
    this->Warning->setVisible(!text.isEmpty());
  }
}
